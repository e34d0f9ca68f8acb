#pragma once

#include <span>
#include <string>
#include <vector>

#include "mlo/evaluation/plot.hpp"
#include "mlo/evaluation/trajectory_error.hpp"

namespace mlo {

/// An estimate, how it was paired with the truth, and its errors.
struct TrajectoryEvaluation {
  std::string name;
  PoseMatching matching;
  TrajectoryErrors errors;
};

/// What a plot shows as ground: x and y (lidar and map frames) or x and z (camera frames).
enum class GroundPlane { xy, xz };

/// Path (with the truth of the first estimate), position errors, translation and rotation errors of the
/// steps, one curve per estimate.
std::vector<PlotPanel> trajectory_panels(std::span<const TrajectoryEvaluation> evaluations,
                                         GroundPlane plane);

}  // namespace mlo
