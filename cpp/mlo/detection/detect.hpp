#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/core/types.hpp"
#include "mlo/detection/config.hpp"
#include "mlo/network/network.hpp"

namespace mlo {

/// What a detector makes of one scan.
struct FoundObjects {
  std::vector<Detection> objects;  ///< most confident first, in the lidar frame at the time of the scan
  std::vector<Detection> likely;   ///< all that may be something, for the next scan to look back at
};

/// What the scan before left.
struct FoundBefore {
  std::vector<Detection> likely;  ///< in the lidar frame of then
  SE3 T_now_before;               ///< from there to the lidar frame of now
};

/// Boxes with class and confidence in one scan, by the detector of the configuration. Coordinates must be
/// finite.
/// @param is_ground  per point: 1 ground, 0 not
/// @param before     nothing: the scan is judged by itself
/// @param network    needed by that detector alone
FoundObjects detect(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                    const std::optional<FoundBefore>& before, const DetectionConfig& config,
                    const Network* network = nullptr);

}  // namespace mlo
