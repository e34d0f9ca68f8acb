#pragma once

#include <array>

#include <Eigen/Core>

#include "mlo/mapping/config.hpp"
#include "mlo/mapping/local_map.hpp"

namespace mlo {

/// A place in the map and the directions in which it holds a point: the match of one scan point.
/// The weighted squared distance is sum_i weight_i (direction_i . (p - q))^2: one direction for a plane,
/// two for a line, three for a distribution.
struct ShapeMatch {
  int num_directions = 0;  ///< 0: no match
  Eigen::Vector3f q_map = Eigen::Vector3f::Zero();
  std::array<Eigen::Vector3f, 3> directions;
  std::array<float, 3> weights{};  ///< in (0, 1]; 1 for the direction that a plane holds

  double squared_distance_m2(const Eigen::Vector3d& p_map) const;
};

enum class ExpectedShape { plane, line };

/// What the neighbours say of the surface around a query.
/// LOAM's model (Zhang and Singh 2014, section VI): a plane, or a line for edge points, or nothing.
/// Distribution: a plane where they are flat; elsewhere the principal axes, weighted by
/// noise^2 / (noise^2 + variance), so that scattered neighbours hold a point weakly and in proportion.
ShapeMatch describe(const NearestPoints& neighbours, ExpectedShape expected, const RefinementConfig& config);

}  // namespace mlo
