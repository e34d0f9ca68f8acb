#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"

namespace mlo {

/// What a point is taken for once ground and objects have corrected each other.
enum class PointKind : std::uint8_t {
  background,
  ground,
  object,
  ambiguous,  ///< both ground and object: takes no part in anything
};

/// The mutual correction of the paper: object points leave the ground, ground points leave the objects.
/// @param is_ground   per point: 1 ground, 0 background (ground.hpp)
/// @param object_ids  per point: its object or kNoObject (objects.hpp)
std::vector<PointKind> correct_mutually(std::span<const std::uint8_t> is_ground,
                                        std::span<const std::uint16_t> object_ids);

/// The object points of each detection, in scan order: gamma, without ground.
std::vector<std::vector<Point>> collect_objects(std::span<const Point> points,
                                                std::span<const PointKind> kinds,
                                                std::span<const std::uint16_t> object_ids,
                                                std::size_t num_objects);

}  // namespace mlo
