#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/box.hpp"
#include "mlo/core/ego_motion.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/core/types.hpp"

// What a scene file holds (docs/scene_format.md). The order of the fields in archive() is the format: a
// change needs a new version of the file.
namespace mlo {

/// How the scene came to be.
struct SceneMeta {
  std::string program_version = {};
  std::string input = {};                   ///< folder of the scans
  std::string format = {};                  ///< as in Dataset
  std::string sequence = {};                ///< as in Dataset
  std::string configuration = {};           ///< YAML
  std::optional<SE3> T_camera0_lidar = {};  ///< KITTI's rectified camera 0, where known

  static void archive(auto& self, auto& bytes) {
    bytes(self.program_version, self.input, self.format, self.sequence, self.configuration,
          self.T_camera0_lidar);
  }
};

/// Where the pose of a scan comes from.
enum class ScanStatus : std::uint8_t {
  first,      ///< it defines the map frame
  localised,  ///< found in the map
  predicted,  ///< too few matches: constant motion or odometry
  skipped     ///< the scan could not be read: constant motion
};
inline constexpr std::size_t kNumScanStatuses = 4;
constexpr std::string_view to_string(ScanStatus status) {
  switch (status) {
    case ScanStatus::first:
      return "first";
    case ScanStatus::localised:
      return "localised";
    case ScanStatus::predicted:
      return "predicted";
    case ScanStatus::skipped:
      break;
  }
  return "skipped";
}

/// An object at the stamp of a scan.
struct SceneObject {
  long id = 0;
  ObjectClass object_class = ObjectClass::car;
  bool detected = false;  ///< in this scan; else predicted
  bool moving = false;
  double moving_probability = 0.5;  ///< by its velocity alone
  double existence = 0.0;           ///< log-odds
  std::uint32_t num_points = 0;
  SE3 T_map_object = {};
  Eigen::Vector3d size_lwh_m = Eigen::Vector3d::Zero();
  Eigen::Vector2d velocity_map_mps = Eigen::Vector2d::Zero();
  double turn_rate_radps = 0.0;
  Eigen::Matrix4d planar_covariance = Eigen::Matrix4d::Zero();  ///< of [x; y; vx; vy] in the map frame
  Eigen::Matrix2d yaw_covariance = Eigen::Matrix2d::Zero();     ///< of [yaw; turn rate]

  static void archive(auto& self, auto& bytes) {
    bytes(self.id, self.object_class, self.detected, self.moving, self.moving_probability, self.existence,
          self.num_points, self.T_map_object, self.size_lwh_m, self.velocity_map_mps, self.turn_rate_radps,
          self.planar_covariance, self.yaw_covariance);
  }
};

/// One scan: where the robot was, and the objects around it.
struct SceneScan {
  std::uint64_t frame = 0;
  double stamp_s = 0.0;
  ScanStatus status = ScanStatus::skipped;
  std::string problem = {};  ///< why it was skipped
  SE3 T_map_lidar = {};
  SE3 T_odom_lidar = {};
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< as in PoseEstimate
  EstimateStatus odometry = EstimateStatus::not_run;
  EstimateStatus refinement = EstimateStatus::not_run;
  std::int32_t degenerate_directions = 0;
  std::uint64_t num_matches = 0;
  std::vector<SceneObject> objects = {};

  static void archive(auto& self, auto& bytes) {
    bytes(self.frame, self.stamp_s, self.status, self.problem, self.T_map_lidar, self.T_odom_lidar,
          self.covariance, self.odometry, self.refinement, self.degenerate_directions, self.num_matches,
          self.objects);
  }
};

/// Consecutive points of the same kind.
struct PointGroup {
  MapLabel label = MapLabel::unknown;
  long object = 0;  ///< id of the track that the points belong to; 0: none
  std::uint64_t count = 0;
  bool operator==(const PointGroup&) const = default;
  static void archive(auto& self, auto& bytes) { bytes(self.label, self.object, self.count); }
};

struct ScenePoint {
  Eigen::Vector3f p = Eigen::Vector3f::Zero();  ///< [m]
  float intensity = 0.0F;
};

/// What a scan saw, without distortion, in the lidar frame at its stamp; or a piece of the map, in the map
/// frame.
struct SceneCloud {
  std::vector<ScenePoint> points = {};
  std::vector<PointGroup> groups = {};  ///< their counts add up to the number of points

  /// Appends a point; it joins the last group where that is of its kind.
  void add(const ScenePoint& point, MapLabel label, long object = 0);
};

/// Calls visit(point, group) for each point in order.
template <class Visit>
void for_each_point(const SceneCloud& cloud, const Visit& visit) {
  std::size_t i = 0;
  for (const PointGroup& group : cloud.groups) {
    for (std::uint64_t k = 0; k < group.count; ++k) visit(cloud.points[i++], group);
  }
}

}  // namespace mlo
