#pragma once

#include <span>

#include "mlo/core/features.hpp"
#include "mlo/core/types.hpp"
#include "mlo/perception/config.hpp"
#include "mlo/perception/ground.hpp"

namespace mlo {

/// Multi-task fusion perception (paper, section III-B): ground, objects and the features of the environment.
/// Coordinates must be finite. Points without a ring give no edges, and features of
/// ground and surfaces by place alone.
/// @param detections  boxes in the lidar frame at the time of the scan; objects of the result keep their
/// order
Percept perceive(const Scan& scan, std::span<const Detection> detections, const PerceptionConfig& config);

/// The same with the ground of the scan as segment_ground() found it.
Percept perceive(const Scan& scan, const GroundSegmentation& ground, std::span<const Detection> detections,
                 const PerceptionConfig& config);

}  // namespace mlo
