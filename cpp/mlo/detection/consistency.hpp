#pragma once

#include <span>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/detection/config.hpp"

namespace mlo {

/// Probabilities in view of the scan before: to the log-odds of a box is added a share of those that the
/// nearest box of its class had there; a box without any near it loses some. What stands as one thing in scan
/// after scan grows sure, what comes and goes (bushes, corners of walls) does not.
/// @param now     detections of this scan; their confidences are probabilities
/// @param before  what this function gave for the scan before, in the lidar frame of then
/// @return `now`, in its order, with other confidences
std::vector<Detection> weigh_by_previous(std::vector<Detection> now, std::span<const Detection> before,
                                         const SE3& T_now_before, const RecurrenceConfig& config);

}  // namespace mlo
