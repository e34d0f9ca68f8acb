#pragma once

#include <numbers>

#include "mlo/core/box.hpp"
#include "mlo/tracking/placed_box.hpp"

namespace mlo::test {

inline constexpr double kDegree = std::numbers::pi / 180.0;
inline constexpr double kDt_s = 0.1;  // between scans

/// A car's box on the ground, 1.7 m below the lidar.
inline Box3d car_box(double x_m, double y_m, double yaw_rad = 0.0) {
  return {{x_m, y_m, -0.95}, {4.0, 1.6, 1.5}, yaw_rad};
}

inline Detection car(double x_m, double y_m, double yaw_rad = 0.0, double confidence = 0.9999) {
  return {ObjectClass::car, car_box(x_m, y_m, yaw_rad), confidence};
}

inline PlacedBox placed_car(double x_m, double y_m, double yaw_rad = 0.0) {
  return place(car_box(x_m, y_m, yaw_rad), SE3());
}

}  // namespace mlo::test
