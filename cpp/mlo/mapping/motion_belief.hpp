#pragma once

#include <algorithm>

#include "mlo/core/log_odds.hpp"
#include "mlo/mapping/config.hpp"
#include "mlo/mapping/displacement.hpp"

namespace mlo {

/// Log-odds that an object that rested has begun to move, by one scan: a weighted sum of its speed and of how
/// its points and those of its map fit each other.
/// @param moving_probability  by its speed
/// @param displacement        known
inline double motion_belief(double moving_probability, const Displacement& displacement, const MapFit& map,
                            const MotionWeights& weights) {
  constexpr double kMaxSignificance = 12.0;
  constexpr double kMaxLength_m = 0.5;
  const double fit_gain = displacement.fit_after - displacement.fit_before;
  return weights.bias + weights.per_speed_logit * log_odds(std::clamp(moving_probability, 0.01, 0.99)) +
         weights.per_significance * std::min(displacement.significance(), kMaxSignificance) +
         weights.per_m * std::min(displacement.length_m(), kMaxLength_m) +
         weights.per_fit_gain * std::clamp(fit_gain, -0.1, 0.5) + weights.per_map_misfit * map.misfit +
         weights.per_map_gain * std::clamp(map.gain, -0.3, 0.7);
}

}  // namespace mlo
