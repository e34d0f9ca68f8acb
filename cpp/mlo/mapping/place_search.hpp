#pragma once

#include <span>

#include "mlo/mapping/config.hpp"
#include "mlo/mapping/refinement.hpp"

namespace mlo {

/// Finds the pose of a scan in a map from a rough guess: starts on a grid around it are ranked by how many
/// points lie on the map, the best are registered, and the one whose points then fit best counts. The scan is
/// taken as it is, with its distortion.
/// @param terms  the scan's points with the maps they belong to; the maps must cover the surroundings
/// @param T_map_lidar_guess  height, roll and pitch are searched for by the registration alone
/// @return T_map_lidar; too_few_matches where too small a part of the points fits
/// (PlaceSearchConfig::min_share)
PoseEstimate find_place(std::span<const RefinementTerm> terms, const SE3& T_map_lidar_guess,
                        const PlaceSearchConfig& search, const RefinementConfig& refinement);

}  // namespace mlo
