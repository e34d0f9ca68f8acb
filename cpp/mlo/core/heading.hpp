#pragma once

#include <cmath>

#include "mlo/core/se3.hpp"

namespace mlo {

/// Direction of a pose's x axis seen from above [rad].
inline double yaw_of(const SE3& pose) {
  const Eigen::Vector3d heading = pose.rotation() * Eigen::Vector3d::UnitX();
  return std::atan2(heading.y(), heading.x());
}

}  // namespace mlo
