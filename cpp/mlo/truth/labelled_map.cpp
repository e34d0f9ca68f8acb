#include "mlo/truth/labelled_map.hpp"

#include <array>
#include <utility>

#include <fmt/format.h>
#include <tsl/robin_set.h>

#include "mlo/core/error.hpp"
#include "mlo/core/voxel_grid.hpp"
#include "mlo/truth/placed_scan.hpp"

namespace mlo {
namespace {

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
                               const PoseList& poses, double voxel_m, Movable movable) {
  const PosesByFrame pose_of(poses);
  Thinned map(voxel_m);
  LabelledMap result;
  for (std::size_t i = 0; i < dataset.scans->size(); ++i) {
    const std::size_t frame = dataset.scans->frame(i);
    const auto fail = [&](const std::string& why) {
      result.problems.push_back(fmt::format("frame {}: {}", frame, why));
    };
    const SE3* pose = pose_of.find(frame);
    if (pose == nullptr) {
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
      const std::vector<Eigen::Vector3f> placed =
          place_scan(*reading.scan, dataset.sensor, *pose, pose_of.motion_per_sweep(frame));
      for (std::size_t k = 0; k < placed.size(); ++k) {
        if (placed[k].allFinite()) map.add({placed[k], mobility_of(of_scan[k], movable)});
      }
      ++result.scans;
    } catch (const InputError& error) {  // this scan's labels; the others may be good
      fail(error.what());
    }
  }
  result.points = std::move(map).take();
  return result;
}

}  // namespace mlo
