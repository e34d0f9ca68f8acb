#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mlo/core/se3.hpp"
#include "mlo/loops/config.hpp"
#include "mlo/loops/place_descriptor.hpp"

namespace mlo {

/// A scan that others are compared with.
struct Keyframe {
  std::size_t scan = 0;  ///< its number in the run
  double way_m = 0.0;    ///< driven up to it
  SE3 T_map_lidar;       ///< as estimated on the way
  PlaceDescriptor place;
};

/// Two keyframes that may have been taken at the same place.
struct LoopCandidate {
  std::size_t earlier = 0;  ///< indices of keyframes
  std::size_t later = 0;
  double yaw_rad = 0.0;  ///< heading of the later in the frame of the earlier
};

/// For each keyframe the earlier one that looks most like it, if that is near enough to where drift can have
/// put it.
std::vector<LoopCandidate> find_loop_candidates(std::span<const Keyframe> keyframes,
                                                const LoopClosureConfig& config);

/// A candidate that was registered.
struct Loop {
  std::size_t earlier = 0;
  std::size_t later = 0;
  SE3 T_earlier_later;
};

/// Without those that no other of the keyframes beside them agrees with: a wrong place is rarely found twice
/// in the same way.
std::vector<Loop> agreeing_loops(std::span<const Loop> loops, std::span<const Keyframe> keyframes);

}  // namespace mlo
