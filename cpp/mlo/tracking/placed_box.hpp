#pragma once

#include <Eigen/Core>

#include "mlo/core/box.hpp"
#include "mlo/core/se3.hpp"

namespace mlo {

/// An upright box in the map frame; as Box3d, which is in the lidar's.
struct PlacedBox {
  Eigen::Vector3d center_map_m = Eigen::Vector3d::Zero();  ///< middle of the box
  Eigen::Vector3d size_lwh_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;  ///< heading about z of the map frame

  SE3 T_map_object() const { return {so3_exp({0.0, 0.0, yaw_rad}), center_map_m}; }
};

/// Between the lidar frame and the map frame. Centres are exact; boxes stay upright in either frame.
PlacedBox place(const Box3d& box, const SE3& T_map_lidar);
Box3d in_lidar(const PlacedBox& box, const SE3& T_map_lidar);

/// The angle in (-pi, pi].
double wrapped_angle(double angle_rad);

/// Share of the smaller one's ground area that lies in the other, in [0, 1], to about 0.05.
double footprint_overlap(const PlacedBox& a, const PlacedBox& b);

}  // namespace mlo
