#pragma once

#include <cmath>
#include <numbers>

namespace mlo::simulator {

/// The same direction in [-pi, pi].
inline double wrapped_rad(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}

}  // namespace mlo::simulator
