#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numbers>

// What the measures share. Internal to evaluation.
namespace mlo {

inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;

/// Similarities are compared with this tolerance, as TrackEval does.
inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// An object is mostly tracked when it is in more than the one share of its frames, mostly lost below the
/// other (Li et al., CVPR 2009).
inline constexpr double kMostlyTracked = 0.8;
inline constexpr double kMostlyLost = 0.2;

/// 0 where nothing is counted.
inline double ratio(double numerator, std::size_t denominator) {
  return numerator / static_cast<double>(std::max<std::size_t>(1, denominator));
}

}  // namespace mlo
