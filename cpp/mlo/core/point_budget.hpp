#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mlo/core/types.hpp"

namespace mlo {

/// Which points of a scan to keep so that no more than `budget` are left, with near and far in balance: where
/// they lie closer than a voxel, one of each voxel is kept, so that near the lidar, where they are dense,
/// most go, and far away none. The voxel's side is the smallest of 5 cm times a power of two that leaves too
/// few; the rest of the budget goes to the farthest of those that half this side would keep as well. Points
/// that are not finite are never kept.
/// @param seed  draws which point of a voxel is kept; nothing: the first
/// @return indices, growing; exactly `budget` of them where there are more finite points than that, all else
std::vector<std::size_t> points_within_budget(std::span<const Point> points, std::size_t budget,
                                              std::optional<std::uint64_t> seed = std::nullopt);

/// The points themselves, in the order given.
std::vector<Point> thin_points(std::span<const Point> points, std::size_t budget,
                               std::optional<std::uint64_t> seed = std::nullopt);

}  // namespace mlo
