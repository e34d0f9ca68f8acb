#include "mlo/loops/loop_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

// How far apart two visits of a place may be across the way, drift or not.
constexpr double kBeside_m = 5.0;

// Loops of keyframes this near to each other must tell the same story.
constexpr std::size_t kNeighbours = 5;
constexpr double kAgree_m = 0.3;
constexpr double kAgree_rad = 1.0 * std::numbers::pi / 180.0;

std::optional<LoopCandidate> most_alike(std::span<const Keyframe> keyframes, std::size_t later,
                                        const LoopClosureConfig& config) {
  const Keyframe& here = keyframes[later];
  std::optional<LoopCandidate> best;
  double best_difference = config.max_difference;
  for (std::size_t earlier = 0; earlier < later; ++earlier) {
    const Keyframe& there = keyframes[earlier];
    const double way_m = here.way_m - there.way_m;
    if (way_m < config.min_way_m) break;  // so are all that follow
    const double distance_m = (here.T_map_lidar.translation() - there.T_map_lidar.translation()).norm();
    if (distance_m > kBeside_m + config.drift * way_m) continue;
    const PlaceDifference difference = compare(there.place, here.place);
    if (difference.value >= best_difference) continue;
    best_difference = difference.value;
    best = {.earlier = earlier, .later = later, .yaw_rad = difference.yaw_rad};
  }
  return best;
}

// Where a loop puts the later keyframe.
SE3 T_map_later(const Loop& loop, std::span<const Keyframe> keyframes) {
  return keyframes[loop.earlier].T_map_lidar * loop.T_earlier_later;
}

bool agree(const Loop& a, const Loop& b, std::span<const Keyframe> keyframes) {
  const SE3 by_way = keyframes[a.later].T_map_lidar.inverse() * keyframes[b.later].T_map_lidar;
  const SE3 by_loops = T_map_later(a, keyframes).inverse() * T_map_later(b, keyframes);
  const SE3 difference = by_way.inverse() * by_loops;
  return difference.translation().norm() < kAgree_m && difference.rotation_angle_rad() < kAgree_rad;
}

}  // namespace

std::vector<LoopCandidate> find_loop_candidates(std::span<const Keyframe> keyframes,
                                                const LoopClosureConfig& config) {
  std::vector<std::optional<LoopCandidate>> found(keyframes.size());
  parallel_for_each_index(keyframes.size(),
                          [&](std::size_t i) { found[i] = most_alike(keyframes, i, config); });
  std::vector<LoopCandidate> candidates;
  for (const std::optional<LoopCandidate>& candidate : found) {
    if (candidate) candidates.push_back(*candidate);
  }
  return candidates;
}

std::vector<Loop> agreeing_loops(std::span<const Loop> loops, std::span<const Keyframe> keyframes) {
  std::vector<Loop> kept;
  for (const Loop& loop : loops) {
    const auto supports = [&](const Loop& other) {
      const std::size_t apart = std::max(loop.later, other.later) - std::min(loop.later, other.later);
      return apart > 0 && apart <= kNeighbours && agree(loop, other, keyframes);
    };
    if (std::any_of(loops.begin(), loops.end(), supports)) kept.push_back(loop);
  }
  return kept;
}

}  // namespace mlo
