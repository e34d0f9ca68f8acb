#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"

namespace mlo::test {

/// Points on the side and the back of a car (with a cabin, so that its motion along itself shows), in the
/// car's frame.
inline std::vector<Eigen::Vector3d> car_surface(double spacing_m = 0.12) {
  std::vector<Eigen::Vector3d> points;
  for (double x = -2.0; x <= 2.0; x += spacing_m) {
    for (double z = -0.6; z <= 0.1; z += spacing_m) points.emplace_back(x, -0.8, z);
    if (std::abs(x) < 1.1) {
      for (double z = 0.1; z <= 0.7; z += spacing_m) points.emplace_back(x, -0.65, z);
    }
  }
  for (double y = -0.8; y <= 0.8; y += spacing_m) {
    for (double z = -0.6; z <= 0.1; z += spacing_m) points.emplace_back(-2.0, y, z);
    for (double z = 0.1; z <= 0.7; z += spacing_m) points.emplace_back(-1.1, 0.8 * y, z);
  }
  return points;
}

/// The same as the lidar sees it, with noise.
inline std::vector<Eigen::Vector3d> seen_from_lidar(const SE3& L_lidar_object, double noise_m,
                                                    unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise_m);
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& p : car_surface()) {
    points.emplace_back(L_lidar_object * p + Eigen::Vector3d(normal(random), normal(random), normal(random)));
  }
  return points;
}

inline std::vector<Point> as_scan(const std::vector<Eigen::Vector3d>& points) {
  std::vector<Point> scan;
  for (const Eigen::Vector3d& p : points)
    scan.push_back({.p_lidar = p.cast<float>(), .sweep_fraction = 0.5F});
  return scan;
}

}  // namespace mlo::test
