#pragma once

#include <span>

#include "mlo/core/ego_motion.hpp"
#include "mlo/core/features.hpp"
#include "mlo/core/sweep_motion.hpp"
#include "mlo/mapping/config.hpp"
#include "mlo/mapping/local_map.hpp"
#include "mlo/mapping/neighbourhood.hpp"

namespace mlo {

/// Some of a scan's points with the map they belong to.
struct RefinementTerm {
  std::span<const FeaturePoint> points;
  const LocalMap* map = nullptr;
  ExpectedShape expected = ExpectedShape::plane;
};

/// What is known before a scan is registered.
struct RefinementGuess {
  SE3 T_map_lidar_previous;  ///< pose of the previous scan, at its reference time
  SE3 T_previous_current;    ///< increment as predicted or as odometry has it
  bool motion_known = true;  ///< false: search wide
  SweepTiming timing;
};

/// Scan-to-map registration by iterated matching and Gauss-Newton (section III-D-2). While the pose is found,
/// the points are brought to the reference time with the increment that it implies.
/// @return T_map_lidar at the reference time; when there are too few matches, the guess, flagged
PoseEstimate refine(std::span<const RefinementTerm> terms, const RefinementGuess& guess,
                    const RefinementConfig& config);

}  // namespace mlo
