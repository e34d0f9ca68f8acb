#include "mlo/simulator/terrain.hpp"

#include <cmath>

namespace mlo::simulator {

double Terrain::height(const Eigen::Vector2d& p_world) const {
  double z = 0.0;
  for (const Wave& wave : waves) {
    z += wave.amplitude_m * std::sin(wave.wave_vector_rad_per_m.dot(p_world) + wave.phase_rad);
  }
  return z;
}

Eigen::Vector2d Terrain::gradient(const Eigen::Vector2d& p_world) const {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (const Wave& wave : waves) {
    const double phase = wave.wave_vector_rad_per_m.dot(p_world) + wave.phase_rad;
    slope += wave.amplitude_m * std::cos(phase) * wave.wave_vector_rad_per_m;
  }
  return slope;
}

SE3 stand_on(const Terrain& terrain, const Eigen::Vector2d& p_world, double yaw_rad, double lift_m) {
  const Eigen::Vector2d slope = terrain.gradient(p_world);
  const Eigen::Vector3d up = Eigen::Vector3d(-slope.x(), -slope.y(), 1.0).normalized();
  const Eigen::Vector3d heading(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
  const Eigen::Vector3d left = up.cross(heading).normalized();
  Eigen::Matrix3d rotation;
  rotation << left.cross(up), left, up;
  return {Eigen::Quaterniond(rotation), {p_world.x(), p_world.y(), terrain.height(p_world) + lift_m}};
}

SE3 stand_upright_on(const Terrain& terrain, const Eigen::Vector2d& p_world, double yaw_rad, double lift_m) {
  return {so3_exp({0.0, 0.0, yaw_rad}), {p_world.x(), p_world.y(), terrain.height(p_world) + lift_m}};
}

}  // namespace mlo::simulator
