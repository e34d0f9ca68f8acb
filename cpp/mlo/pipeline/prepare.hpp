#pragma once

#include "mlo/core/types.hpp"
#include "mlo/pipeline/config.hpp"

namespace mlo {

/// The scan as perception takes it: cropped to the sensor's range limits and the region of interest, without
/// points that are not finite, elevations corrected.
Scan prepare(const Scan& scan, const SensorConfig& sensor, const InputConfig& input);

}  // namespace mlo
