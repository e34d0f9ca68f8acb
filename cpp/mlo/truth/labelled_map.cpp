#include "mlo/truth/labelled_map.hpp"

#include <array>
#include <map>

#include <fmt/format.h>
#include <tsl/robin_set.h>

#include "mlo/core/error.hpp"
#include "mlo/core/sweep_motion.hpp"
#include "mlo/core/voxel_grid.hpp"
#include "mlo/io/labelled_points.hpp"
#include "mlo/io/sweep_structure.hpp"

namespace mlo {
namespace {

using PoseByFrame = std::map<std::size_t, SE3>;

PoseByFrame by_frame(const PoseList& poses) {
  PoseByFrame result;
  for (std::size_t i = 0; i < poses.frames.size(); ++i)
    result.emplace(poses.frames[i], poses.T_world_body[i]);
  return result;
}

// Motion during one sweep: between the neighbours of the frame, or from the one that there is.
SE3 motion_per_sweep(const PoseByFrame& poses, PoseByFrame::const_iterator at) {
  const auto first = at == poses.begin() ? at : std::prev(at);
  const auto last = std::next(at) == poses.end() ? at : std::next(at);
  if (first == last) return {};
  const auto sweeps = static_cast<double>(last->first - first->first);
  return interpolate(first->second.inverse() * last->second, 1.0 / sweeps);
}

// Collects points, one per voxel and mobility.
class Thinned {
 public:
  explicit Thinned(double voxel_m) : inverse_size_(static_cast<float>(1.0 / voxel_m)) {}

  void add(const LabelledPoint& point) {
    auto& taken = taken_[static_cast<std::size_t>(point.mobility)];
    if (taken.insert(voxel_key(point.p_map, inverse_size_)).second) points_.push_back(point);
  }
  std::vector<LabelledPoint> take() && { return std::move(points_); }

 private:
  float inverse_size_;
  std::array<tsl::robin_set<VoxelKey, VoxelKeyHash>, 3> taken_;  // by mobility
  std::vector<LabelledPoint> points_;
};

// Why the labels do not fit the scan; empty if they do.
std::string mismatch(const ScanReading& reading, std::size_t labels) {
  if (reading.invalid_points > 0) {
    return fmt::format("{} points without coordinates leave it open which label belongs to which point",
                       reading.invalid_points);
  }
  if (labels == reading.scan->points.size()) return {};
  return fmt::format("{} labels for {} points", labels, reading.scan->points.size());
}

void add_scan(const Scan& scan, const std::vector<std::uint32_t>& labels, const SensorConfig& sensor,
              const SE3& T_map_lidar, const SE3& motion, Thinned& map) {
  std::vector<Point> points = scan.points;
  correct_vertical_angle(points, sensor.vertical_correction_deg);
  const SweepMotion distortion =
      scan.motion_compensated ? SweepMotion::none() : SweepMotion(motion, scan.stamp_fraction);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p_lidar = points[i].p_lidar.cast<double>();
    const double range_m = p_lidar.norm();
    if (!(range_m >= sensor.min_range_m && range_m <= sensor.max_range_m)) continue;
    const Eigen::Vector3d at_stamp =
        distortion.undistort(p_lidar, static_cast<double>(points[i].sweep_fraction));
    map.add({(T_map_lidar * at_stamp).cast<float>(), mobility_of(labels[i])});
  }
}

}  // namespace

std::optional<std::filesystem::path> find_point_labels(const Dataset& dataset) {
  const std::filesystem::path beside = dataset.root / "labels";
  const std::filesystem::path of_part =
      dataset.root.parent_path().parent_path() / "labels" / dataset.root.filename();
  for (const auto& folder : {beside, of_part}) {
    if (is_directory(folder)) return folder;
  }
  return std::nullopt;
}

LabelledMap build_labelled_map(const Dataset& dataset, const std::filesystem::path& labels,
                               const PoseList& poses, double voxel_m) {
  const PoseByFrame pose_of = by_frame(poses);
  Thinned map(voxel_m);
  LabelledMap result;
  for (std::size_t i = 0; i < dataset.scans->size(); ++i) {
    const std::size_t frame = dataset.scans->frame(i);
    const auto fail = [&](const std::string& why) {
      result.problems.push_back(fmt::format("frame {}: {}", frame, why));
    };
    const auto pose = pose_of.find(frame);
    if (pose == pose_of.end() || !pose->second.is_finite()) {
      fail("no pose");
      continue;
    }
    const ScanReading reading = dataset.scans->read(i);
    if (!reading.scan) {
      fail(reading.problem);
      continue;
    }
    try {
      const std::vector<std::uint32_t> of_scan =
          read_semantic_labels(labels / fmt::format("{:06d}.label", frame));
      if (const std::string why = mismatch(reading, of_scan.size()); !why.empty()) {
        fail(why);
        continue;
      }
      add_scan(*reading.scan, of_scan, dataset.sensor, pose->second, motion_per_sweep(pose_of, pose), map);
      ++result.scans;
    } catch (const InputError& error) {  // this scan's labels; the others may be good
      fail(error.what());
    }
  }
  result.points = std::move(map).take();
  return result;
}

}  // namespace mlo
