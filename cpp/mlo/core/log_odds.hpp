#pragma once

#include <algorithm>
#include <cmath>

namespace mlo {

/// Natural logarithm of the odds of a probability in [0, 1], finite for 0 and 1, too; and back.
inline double log_odds(double probability) {
  constexpr double kTiny = 1e-9;
  const double p = std::clamp(probability, kTiny, 1.0 - kTiny);
  return std::log(p / (1.0 - p));
}
inline double probability(double log_odds) {
  return 1.0 / (1.0 + std::exp(-log_odds));
}

}  // namespace mlo
