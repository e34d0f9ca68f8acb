#pragma once

#include <string>

#include "mlo/core/se3.hpp"

namespace mlo::simulator {

/// Poses of the IMU one step before, at, and one step after a record; world: x east, y north, z up [m].
struct ImuPoses {
  SE3 T_world_imu_before, T_world_imu, T_world_imu_after;
  double step_s = 0.01;
};

/// A line of KITTI's oxts format (30 numbers). The world's origin lies at 49 degrees north, 8.4 east;
/// positions become latitude and longitude by the inverse of the Mercator projection that KITTI's tools use.
std::string oxts_line(const ImuPoses& poses);

}  // namespace mlo::simulator
