#pragma once

#include <optional>

#include <Eigen/Core>

#include "mlo/core/box.hpp"
#include "mlo/core/se3.hpp"

namespace mlo {

/// A box as KITTI's label files have it: upright in the rectified camera 0, whose x points right, y down, z
/// ahead.
struct KittiBox {
  Eigen::Vector3d bottom_camera0_m = Eigen::Vector3d::Zero();  ///< middle of the bottom face
  double height_m = 0.0;
  double width_m = 0.0;
  double length_m = 0.0;
  double rotation_y_rad = 0.0;  ///< heading about y: 0 along x (right), pi/2 along -z (back)
};

/// The box in the lidar frame. Its centre is exact; it becomes upright in the lidar frame, whose z axis is
/// off the camera's y axis by the tilt of the mounting (about one degree on KITTI's car).
Box3d box_in_lidar(const KittiBox& box, const SE3& T_camera0_lidar);

/// The inverse of box_in_lidar: gives back the same numbers. rotation_y in (-pi, pi].
KittiBox box_in_camera(const Box3d& box, const SE3& T_camera0_lidar);

/// KITTI's observation angle: rotation_y less the direction to the box, in (-pi, pi].
double observation_angle_rad(const KittiBox& box);

/// Smallest rectangle around that part of the box's projection that lies in the image. What reaches behind
/// the camera is cut in front of it. Nothing when the box is not in the image at all.
/// @param P2  projects rectified camera 0 coordinates [m] to image 2 [px]
/// @param image_size_px  width and height
std::optional<Box2d> project_box(const KittiBox& box, const Eigen::Matrix<double, 3, 4>& P2,
                                 const Eigen::Vector2d& image_size_px);

}  // namespace mlo
