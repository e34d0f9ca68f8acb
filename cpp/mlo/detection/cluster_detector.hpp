#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"
#include "mlo/detection/candidates.hpp"
#include "mlo/detection/config.hpp"

namespace mlo {

/// All that the clusters of a scan may be, unjudged.
/// @param is_ground  per point: 1 ground, 0 not
std::vector<Candidate> find_candidates(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                                       const ClusterConfig& config);

/// Objects in a scan, without a network: clusters of the points above the ground, seen from above, at several
/// gap sizes; to each a rectangle is fitted, completed to the typical size of a class and judged by a
/// logistic model. Of boxes that overlap the most probable one is kept. Coordinates must be finite.
/// @param is_ground  per point: 1 ground, 0 not; without any ground there are no objects
/// @return most probable first, in the lidar frame at the time of the scan; confidences are probabilities, at
/// least min_candidate
std::vector<Detection> detect_clusters(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                                       const ClusterConfig& config);

}  // namespace mlo
