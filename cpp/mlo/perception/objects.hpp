#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"

namespace mlo {

/// Id of points that belong to no object.
inline constexpr std::uint16_t kNoObject = 0xFFFF;

/// Which detected box holds each point: the ids of Phi_s, indices into `detections`. Where boxes overlap the
/// most confident one has the point; among equals the one whose middle is nearer, then the first.
/// @param margin_m  boxes count as this much larger on every side [m], >= 0
std::vector<std::uint16_t> label_objects(std::span<const Point> points, std::span<const Detection> detections,
                                         double margin_m);

}  // namespace mlo
