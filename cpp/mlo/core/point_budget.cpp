#include "mlo/core/point_budget.hpp"

#include <algorithm>
#include <utility>

#include "mlo/core/random.hpp"
#include "mlo/core/voxel_grid.hpp"

namespace mlo {
namespace {

constexpr float kFinest_m = 0.05F;
constexpr int kLevels = 24;           // up to 400 km: more than any lidar sees
constexpr float kReach_m = 50000.0F;  // farther points share the outermost voxels, whose numbers stay small

using Indices = std::vector<std::size_t>;

Indices finite_points(std::span<const Point> points) {
  Indices indices;
  indices.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].p_lidar.allFinite()) indices.push_back(i);
  }
  return indices;
}

/// What is in `all` and not in its subsequence `part`.
Indices without(const Indices& all, const Indices& part) {
  Indices rest;
  auto next = part.begin();
  for (const std::size_t index : all) {
    if (next != part.end() && *next == index) {
      ++next;
    } else {
      rest.push_back(index);
    }
  }
  return rest;
}

/// Adds the farthest of the candidates until there are `budget`.
void fill_with_farthest(Indices& kept, Indices candidates, std::span<const Point> points,
                        std::size_t budget) {
  const auto count = static_cast<std::ptrdiff_t>(std::min(budget - kept.size(), candidates.size()));
  std::ranges::partial_sort(candidates, candidates.begin() + count, [&](std::size_t a, std::size_t b) {
    const float range_a = points[a].p_lidar.squaredNorm();
    const float range_b = points[b].p_lidar.squaredNorm();
    return range_a != range_b ? range_a > range_b : a < b;
  });
  kept.insert(kept.end(), candidates.begin(), candidates.begin() + count);
}

}  // namespace

std::vector<std::size_t> points_within_budget(std::span<const Point> points, std::size_t budget,
                                              std::optional<std::uint64_t> seed) {
  Indices indices = finite_points(points);
  if (indices.size() <= budget) return indices;
  if (seed) shuffle(indices, *seed);
  const auto position = [&](std::size_t i) -> Eigen::Vector3f {
    return points[i].p_lidar.cwiseMax(-kReach_m).cwiseMin(kReach_m);
  };
  // Voxels of a level are made of eight of the one before: what a level keeps, all finer ones keep.
  Indices coarser;
  float voxel_m = kFinest_m;
  for (int level = 0; level < kLevels; ++level, voxel_m *= 2.0F) {
    coarser = downsample_first<std::size_t>(indices, voxel_m, position);
    if (coarser.size() <= budget) break;
    indices = std::exchange(coarser, {});
  }
  Indices kept = coarser;
  fill_with_farthest(kept, without(indices, coarser), points, budget);
  std::ranges::sort(kept);
  return kept;
}

std::vector<Point> thin_points(std::span<const Point> points, std::size_t budget,
                               std::optional<std::uint64_t> seed) {
  std::vector<Point> kept;
  for (const std::size_t i : points_within_budget(points, budget, seed)) kept.push_back(points[i]);
  return kept;
}

}  // namespace mlo
