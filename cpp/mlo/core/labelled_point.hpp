#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace mlo {

/// Whether what a point lies on moved while it was seen.
enum class Mobility : std::uint8_t { unknown, at_rest, moving };

/// A point of which somebody (an annotator, a simulator) knows whether it belongs into a static map.
struct LabelledPoint {
  Eigen::Vector3f p_map = Eigen::Vector3f::Zero();  ///< map frame [m]
  Mobility mobility = Mobility::unknown;
};

}  // namespace mlo
