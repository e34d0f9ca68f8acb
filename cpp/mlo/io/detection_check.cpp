#include "mlo/io/detection_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "mlo/io/kitti_box.hpp"

namespace mlo {
namespace {

using Undo = Box3d (*)(const Box3d&, const SE3& T_camera0_lidar);

/// A mistake and the box that was meant.
struct Mistake {
  std::string_view name;
  Undo undo;
};

Box3d raised(Box3d box, double heights) {
  box.center_lidar_m.z() += heights * box.size_lwh_m.z();
  return box;
}

Box3d turned(Box3d box, double yaw_rad) {
  box.yaw_rad = yaw_rad;
  return box;
}

Box3d from_camera(const Box3d& box, const SE3& T_camera0_lidar) {
  const Eigen::Vector3d& size = box.size_lwh_m;
  return box_in_lidar({box.center_lidar_m, size.z(), size.y(), size.x(), box.yaw_rad}, T_camera0_lidar);
}

/// The first is no mistake. Where several explain the scans equally well, the first of them is named.
constexpr std::array<Mistake, 9> kMistakes{{
    {"", [](const Box3d& box, const SE3&) { return box; }},
    {"the boxes are in the camera's frame", from_camera},
    {"z is that of the bottom face, not of the centre",
     [](const Box3d& box, const SE3&) { return raised(box, 0.5); }},
    {"the boxes lie half their height too high",
     [](const Box3d& box, const SE3&) { return raised(box, -0.5); }},
    {"length and width are exchanged, or yaw is off by 90 degrees",
     [](const Box3d& box, const SE3&) { return turned(box, box.yaw_rad + 0.5 * std::numbers::pi); }},
    {"length and height are exchanged",
     [](const Box3d& box, const SE3&) {
       return Box3d{box.center_lidar_m, box.size_lwh_m.reverse(), box.yaw_rad};
     }},
    {"yaw is in degrees",
     [](const Box3d& box, const SE3&) { return turned(box, box.yaw_rad * std::numbers::pi / 180.0); }},
    {"yaw has the wrong sign", [](const Box3d& box, const SE3&) { return turned(box, -box.yaw_rad); }},
    {"yaw is KITTI's rotation_y",
     [](const Box3d& box, const SE3&) { return turned(box, -box.yaw_rad - 0.5 * std::numbers::pi); }},
}};
constexpr std::size_t kCameraFrame = 1;
using Counts = std::array<std::size_t, kMistakes.size()>;

/// A camera at the lidar's place: x right, y down, z ahead.
SE3 nominal_camera() {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return SE3::from_matrix(T);
}

/// Points near a box, in the plane, that stand out from the ground.
std::vector<Eigen::Vector3d> points_around(const Box3d& box, std::span<const Point> points,
                                           const DetectionCheckOptions& options) {
  constexpr double kSurroundings_m = 2.0;  // where the ground is looked for
  constexpr double kLowest = 0.05;         // quantile of the heights that is taken for the ground
  const double reach_m = 0.5 * box.size_lwh_m.norm() + kSurroundings_m;
  std::vector<Eigen::Vector3d> near;
  std::vector<double> heights;
  for (const Point& point : points) {
    const Eigen::Vector3d p = point.p_lidar.cast<double>();
    if ((p - box.center_lidar_m).head<2>().squaredNorm() > reach_m * reach_m) continue;
    near.push_back(p);
    heights.push_back(p.z());
  }
  if (near.empty()) return near;
  const auto lowest =
      heights.begin() + static_cast<std::ptrdiff_t>(kLowest * static_cast<double>(heights.size()));
  std::nth_element(heights.begin(), lowest, heights.end());
  const double floor = *lowest + options.ground_height_m;
  std::erase_if(near, [floor](const Eigen::Vector3d& p) { return p.z() < floor; });
  return near;
}

std::size_t count_inside(const Box3d& box, std::span<const Eigen::Vector3d> points, double margin_m) {
  return static_cast<std::size_t>(std::count_if(
      points.begin(), points.end(), [&](const Eigen::Vector3d& p) { return box.contains(p, margin_m); }));
}

/// Points in the box, for each mistake undone. Only the camera's frame puts it elsewhere.
Counts count_points(const Box3d& box, std::span<const Point> points, const SE3& T_camera0_lidar,
                    const DetectionCheckOptions& options) {
  const std::vector<Eigen::Vector3d> here = points_around(box, points, options);
  const std::vector<Eigen::Vector3d> there =
      points_around(from_camera(box, T_camera0_lidar), points, options);
  Counts counts{};
  for (std::size_t i = 0; i < kMistakes.size(); ++i) {
    const Box3d meant = kMistakes[i].undo(box, T_camera0_lidar);
    counts[i] = count_inside(meant, i == kCameraFrame ? there : here, options.margin_m);
  }
  return counts;
}

bool within_range(const Box3d& box, double max_range_m) {
  return box.center_lidar_m.norm() <= max_range_m;  // false for NaN
}

std::string describe(const DetectionCheck& check) {
  const std::string found = fmt::format("{} of {} boxes hold points", check.boxes_with_points, check.boxes);
  if (!check.mistake.empty()) {
    return fmt::format("{}: {}; correct the detections (docs/detections.md)", found, check.mistake);
  }
  return fmt::format(
      "{}, and no usual mistake explains it; check that detections and scans are of the same "
      "sequence and frames, and that the calibration is theirs",
      found);
}

}  // namespace

DetectionCheck check_detections(std::span<const ScanWithDetections> scans, const Calibration& calibration,
                                const DetectionCheckOptions& options) {
  const SE3 T_camera0_lidar = calibration.T_camera0_lidar.value_or(nominal_camera());
  DetectionCheck check;
  std::array<double, kMistakes.size()> scores{};
  std::size_t scored = 0;
  for (const ScanWithDetections& scan : scans) {
    for (const Detection& detection : scan.detections) {
      if (detection.confidence < options.min_confidence) continue;
      if (!within_range(detection.box, options.max_range_m)) continue;
      const Counts counts = count_points(detection.box, scan.points, T_camera0_lidar, options);
      ++check.boxes;
      if (counts[0] >= options.min_points) ++check.boxes_with_points;
      const std::size_t most = *std::max_element(counts.begin(), counts.end());
      if (most < options.min_points) continue;
      ++scored;
      for (std::size_t i = 0; i < scores.size(); ++i) {
        scores[i] += static_cast<double>(counts[i]) / static_cast<double>(most);
      }
    }
  }
  if (check.boxes == 0) return check;
  for (double& score : scores) score /= static_cast<double>(std::max<std::size_t>(scored, 1));
  const auto best = std::max_element(scores.begin(), scores.end());
  check.score = scores[0];
  check.best_score = *best;
  if (*best > scores[0] + options.min_gain)
    check.mistake = kMistakes[static_cast<std::size_t>(best - scores.begin())].name;
  const auto enough = options.min_share * static_cast<double>(check.boxes);
  const bool few = static_cast<double>(check.boxes_with_points) < enough;
  if (few || !check.mistake.empty()) check.problem = describe(check);
  return check;
}

}  // namespace mlo
