#pragma once

#include <vector>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"
#include "mlo/simulator/path.hpp"
#include "mlo/simulator/terrain.hpp"

namespace mlo::simulator {

/// Where something is in the plane at one time.
struct PlanarState {
  Eigen::Vector2d p_world = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;    ///< continuous in time, not wrapped
  double speed_mps = 0.0;  ///< along the heading; negative when reversing
  double yaw_rate_radps = 0.0;
  double travelled_m = 0.0;  ///< length of the way so far

  Eigen::Vector2d velocity_mps() const;
};

/// A smooth motion in the plane, kept as states at fixed steps from time 0; at rest before and after.
class Motion {
 public:
  static constexpr double kStep_s = 0.05;

  Motion() = default;
  explicit Motion(std::vector<PlanarState> states) : states_(std::move(states)) {}
  static Motion at_rest(const Eigen::Vector2d& p_world, double yaw_rad);

  PlanarState at(double time_s) const;
  double duration_s() const {
    return states_.empty() ? 0.0 : kStep_s * static_cast<double>(states_.size() - 1);
  }
  bool ever_moves() const { return states_.size() > 1; }
  const std::vector<PlanarState>& states() const { return states_; }
  /// This motion, then the next, which must start where this one ends.
  Motion then(const Motion& next) const;

 private:
  std::vector<PlanarState> states_;
};

/// Along a path at given arc lengths and speeds at every step.
/// @param backwards  the heading is against the path: reversing
Motion follow(const Path& path, const std::vector<double>& s_m, const std::vector<double>& speed_mps,
              bool backwards = false);
/// Along a path at one speed that fades in and out, after waiting; the path's whole length.
Motion glide(const Path& path, double speed_mps, double wait_s, bool backwards = false);
/// Along a path at a constant speed for some time, from arc length s_m.
Motion cruise(const Path& path, double s_m, double speed_mps, double duration_s);

/// The robot's body adds to its planar motion: the slope of the ground, squat and roll of the suspension,
/// vibration.
struct Suspension {
  double roll_per_lateral_acceleration_rad = 0.004;  ///< [rad per m/s^2]
  double vibration_rad = 0.0025;                     ///< amplitude of roll and pitch at full speed
  double heave_m = 0.008;                            ///< amplitude of the vertical movement at full speed
  double phase_rad = 0.0;
};

/// The lidar's pose on a robot; its height above the ground is that of KITTI's car.
struct RobotMotion {
  Motion planar;
  Suspension suspension;
  double lidar_height_m = 1.73;

  SE3 T_world_lidar(const Terrain& terrain, double time_s) const;
};

}  // namespace mlo::simulator
