#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "mlo/core/box.hpp"
#include "mlo/core/se3.hpp"

namespace mlo::simulator {

/// The rig of the simulated robot: much like KITTI's, but with calibration values of its own.
/// Camera axes: x right, y down, z ahead. The IMU's are the lidar's: x ahead, y left, z up.
struct Rig {
  Rig();

  double focal_px = 720.0;
  double center_u_px = 610.0;
  double center_v_px = 175.0;
  int image_width_px = 1242;
  int image_height_px = 375;
  SE3 T_camera_lidar;  ///< rectified camera 0
  SE3 T_imu_lidar;

  Eigen::Matrix<double, 3, 4> projection() const;
};

/// What the image shows of a box.
struct ImageView {
  Box2d box;                ///< clipped to the image [px]
  double truncation = 0.0;  ///< share of the unclipped rectangle that lies outside
};
/// Nothing when no part of the box is in front of the camera and inside the image.
std::optional<ImageView> project(const Rig& rig, const Box3d& box_lidar);

/// KITTI's calibration files: that of a tracking sequence, and that of an odometry sequence.
std::string tracking_calibration(const Rig& rig);
std::string odometry_calibration(const Rig& rig);

}  // namespace mlo::simulator
