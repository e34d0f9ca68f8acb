#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"

namespace mlo {

/// A measured pose of one node in the frame of another, with standard deviations in each direction.
struct PoseGraphEdge {
  std::size_t from = 0;
  std::size_t to = 0;
  SE3 T_from_to;
  double sd_m = 1.0;
  double sd_rad = 1.0;
};

/// The poses that fit all edges best, by least squares over the tangent space of the errors
/// log(T_from_to^-1 * T_from^-1 * T_to); Levenberg-Marquardt on the sparse normal equations.
/// @param T_map_node  to start from; the first stays where it is
std::vector<SE3> optimize_pose_graph(std::vector<SE3> T_map_node, std::span<const PoseGraphEdge> edges);

}  // namespace mlo
