#pragma once

#include <optional>
#include <string_view>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"

namespace mlo {

/// What detectors tell apart. `other` is anything movable without a class of its own (tram, trailer).
enum class ObjectClass { car, van, truck, pedestrian, cyclist, other };

/// Lower-case name, and back (KITTI's spellings in any case are understood; unknown names give nothing).
std::string_view to_string(ObjectClass object_class);
std::optional<ObjectClass> object_class_from(std::string_view name);

/// 3D bounding box (3D-BB), Eq. (2): an upright cuboid in the lidar frame.
struct Box3d {
  Eigen::Vector3d center_lidar_m = Eigen::Vector3d::Zero();  ///< middle of the box, not of its bottom face
  Eigen::Vector3d size_lwh_m = Eigen::Vector3d::Zero();      ///< length along heading, width, height
  double yaw_rad = 0.0;  ///< heading about the lidar's z axis, 0 along x, counter-clockwise

  /// L_lt: maps points of the body-fixed frame t (origin at the centre, x ahead, z up) to the lidar frame.
  SE3 T_lidar_object() const;
  /// True if the point lies inside or within margin_m of the box's faces.
  bool contains(const Eigen::Vector3d& p_lidar, double margin_m = 0.0) const;
  // See core/archive.hpp.
  static void archive(auto& self, auto& bytes) { bytes(self.center_lidar_m, self.size_lwh_m, self.yaw_rad); }
};

/// The upright box that an annotator would draw around an object: its centre and heading, without its tilt.
/// @param T_lidar_object  L_lt, body-fixed frame at the centre
Box3d upright_box(const SE3& T_lidar_object, const Eigen::Vector3d& size_lwh_m);

/// Upright rectangle in an image; x to the right, y down.
struct Box2d {
  double left_px = 0.0;
  double top_px = 0.0;
  double right_px = 0.0;
  double bottom_px = 0.0;
};

/// A detector's output: tau and mu of the paper (section III-B-2).
struct Detection {
  ObjectClass object_class = ObjectClass::car;
  Box3d box;
  double confidence = 1.0;  ///< in [0, 1]
  static void archive(auto& self, auto& bytes) { bytes(self.object_class, self.box, self.confidence); }
};

}  // namespace mlo
