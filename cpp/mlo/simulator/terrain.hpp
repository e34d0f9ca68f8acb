#pragma once

#include <vector>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"

namespace mlo::simulator {

/// Smooth ground: a sum of waves, z up [m].
struct Terrain {
  struct Wave {
    Eigen::Vector2d wave_vector_rad_per_m = Eigen::Vector2d::Zero();
    double amplitude_m = 0.0;
    double phase_rad = 0.0;
  };
  std::vector<Wave> waves;

  double height(const Eigen::Vector2d& p_world) const;
  /// Slope along x and y [m/m].
  Eigen::Vector2d gradient(const Eigen::Vector2d& p_world) const;
};

/// Frame with x ahead and z up that stands on the ground, tilted as the ground is; lift_m above it (along z
/// of the world).
SE3 stand_on(const Terrain& terrain, const Eigen::Vector2d& p_world, double yaw_rad, double lift_m = 0.0);
/// The same, but upright: how buildings, poles and people stand.
SE3 stand_upright_on(const Terrain& terrain, const Eigen::Vector2d& p_world, double yaw_rad,
                     double lift_m = 0.0);

}  // namespace mlo::simulator
