#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/types.hpp"
#include "mlo/perception/config.hpp"

namespace mlo {

/// All p with normal . p + offset_m = 0; the normal has unit length and points up.
struct GroundPlane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float offset_m = 0.0F;  ///< for ground, the height of the lidar's origin above the plane [m]

  /// Height of a point above the plane [m].
  float height(const Eigen::Vector3f& p_lidar) const { return normal.dot(p_lidar) + offset_m; }
};

/// Which points of a scan are ground: the marks of Phi_g.
struct GroundSegmentation {
  std::vector<std::uint8_t> is_ground;  ///< per point: 0 background, 1 ground
  GroundPlane nearby;                   ///< plane of the ground around the sensor
  bool found = false;                   ///< false: nothing was taken for ground
};

/// Iterative plane fitting by PCA after Zermas et al. (ICRA 2017), in polar zones: every azimuth sector is
/// walked from near to far, and the last accepted plane says where the next one may lie, so that returns from
/// below the ground (multipath) and raised surfaces start no plane. Where a zone has too few points, or its
/// plane is too steep, bends or jumps too much, the last plane goes on. The height of the sensor comes from
/// the points. Coordinates must be finite.
GroundSegmentation segment_ground(std::span<const Point> points, const GroundConfig& config);

}  // namespace mlo
