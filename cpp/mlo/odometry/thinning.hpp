#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mlo/core/features.hpp"

namespace mlo {

/// The finite ones of `points`, at most max_points of them, evenly spread over their order.
inline std::vector<FeaturePoint> thinned(const std::vector<FeaturePoint>& points, std::size_t max_points) {
  std::vector<FeaturePoint> kept;
  kept.reserve(std::min(points.size(), max_points));
  // Point i is kept where i * max / size steps to the next whole number.
  const std::size_t size = points.size();
  for (std::size_t i = 0; i < size; ++i) {
    const bool chosen = size <= max_points || i * max_points / size != (i + 1) * max_points / size;
    const bool finite = points[i].p_lidar.allFinite() && std::isfinite(points[i].sweep_fraction);
    if (chosen && finite) kept.push_back(points[i]);
  }
  return kept;
}

}  // namespace mlo
