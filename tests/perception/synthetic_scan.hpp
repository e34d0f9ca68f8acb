#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"

namespace mlo::test {

/// A world of known shape, in the lidar frame.
struct Scene {
  std::function<double(double, double)> ground_z;  ///< height of the ground at (x, y) [m]
  std::vector<Box3d> boxes = {};
  double noise_m = 0.01;  ///< standard deviation along the beam
};

/// A scan and what each of its points was measured on.
struct SyntheticScan {
  Scan scan;
  std::vector<std::uint8_t> is_ground;
};

inline constexpr double kFarthest = 60.0;

/// Range at which a ray from the origin enters a box.
inline std::optional<double> range_to_box(const Eigen::Vector3d& direction, const Box3d& box) {
  const SE3 T_object_lidar = box.T_lidar_object().inverse();
  const Eigen::Vector3d from = T_object_lidar * Eigen::Vector3d::Zero();
  const Eigen::Vector3d along = T_object_lidar * direction - from;
  double enter = 0.0;
  double leave = kFarthest;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = 0.5 * box.size_lwh_m[axis];
    const double a = (-half - from[axis]) / along[axis];
    const double b = (half - from[axis]) / along[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter > leave || enter <= 0.0) return std::nullopt;
  return enter;
}

/// Range at which a ray from the origin first falls below the ground, by steps and bisection.
inline std::optional<double> range_to_ground(const Eigen::Vector3d& direction, const Scene& scene) {
  const auto above = [&](double range) {
    const Eigen::Vector3d p = range * direction;
    return p.z() > scene.ground_z(p.x(), p.y());
  };
  constexpr double kStep = 0.1;
  double near = 0.0;
  while (above(near + kStep)) {
    near += kStep;
    if (near > kFarthest) return std::nullopt;
  }
  double far = near + kStep;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (near + far);
    (above(middle) ? near : far) = middle;
  }
  return near;
}

/// 64 rings from +2 to -25 degrees, line by line, each by azimuth growing from ahead.
inline SyntheticScan make_scan(const Scene& scene, int rings = 64, int columns = 720) {
  constexpr double kDegToRad = std::numbers::pi / 180.0;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, scene.noise_m);
  SyntheticScan result;
  for (int ring = 0; ring < rings; ++ring) {
    const double elevation = (2.0 - 27.0 * ring / (rings - 1)) * kDegToRad;
    for (int column = 0; column < columns; ++column) {
      const double azimuth = 2.0 * std::numbers::pi * (column + 0.5) / columns;
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const std::optional<double> ground = range_to_ground(direction, scene);
      double range = ground.value_or(std::numeric_limits<double>::infinity());
      bool is_ground = ground.has_value();
      for (const Box3d& box : scene.boxes) {
        const std::optional<double> to_box = range_to_box(direction, box);
        if (!to_box || *to_box >= range) continue;
        range = *to_box;
        is_ground = false;
      }
      if (!std::isfinite(range)) continue;
      Point point;
      point.p_lidar = ((range + noise(random)) * direction).cast<float>();
      point.ring = static_cast<std::uint16_t>(ring);
      result.scan.points.push_back(point);
      result.is_ground.push_back(is_ground ? 1 : 0);
    }
  }
  return result;
}

/// A box that stands on level ground.
inline Box3d standing_box(double x, double y, double ground_z, const Eigen::Vector3d& size_lwh_m,
                          double yaw_rad = 0.0) {
  return {{x, y, ground_z + 0.5 * size_lwh_m.z()}, size_lwh_m, yaw_rad};
}

/// A street of level ground with cars, a house and a pole; the sensor stands `height_m` above it.
inline Scene street(double height_m) {
  const double z = -height_m;
  return {
      .ground_z = [z](double, double) { return z; },
      .boxes = {standing_box(8.0, 3.0, z, {4.2, 1.8, 1.5}), standing_box(-9.0, -3.0, z, {4.2, 1.8, 1.5}, 0.2),
                standing_box(10.0, 14.0, z, {30.0, 4.0, 6.0}), standing_box(5.0, -5.0, z, {0.3, 0.3, 5.0})}};
}

}  // namespace mlo::test
