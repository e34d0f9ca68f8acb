#pragma once

#include <vector>

#include "mlo/core/box.hpp"

namespace mlo {

/// Non-maximum suppression: the most confident detections, of which no two share more of their ground areas
/// (intersection over union) than allowed, whatever their classes. Most confident first; among equals in the
/// order given.
std::vector<Detection> suppress_overlapping(std::vector<Detection> detections, double max_shared);

}  // namespace mlo
