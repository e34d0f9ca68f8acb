#include "mlo/core/sensor.hpp"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

namespace mlo {

std::vector<double> SensorConfig::elevations_deg() const {
  if (!beam_elevations_deg.empty()) return beam_elevations_deg;
  std::vector<double> elevations;
  for (int ring = 0; ring < rings; ++ring) {
    const double fraction = rings > 1 ? static_cast<double>(ring) / (rings - 1) : 0.5;
    elevations.push_back(max_elevation_deg + fraction * (min_elevation_deg - max_elevation_deg));
  }
  return elevations;
}

std::vector<std::string> SensorConfig::find_problems() const {
  std::vector<std::string> problems;
  if (!(max_range_m > min_range_m)) {
    problems.push_back(
        fmt::format("max_range_m ({}) must be larger than min_range_m ({})", max_range_m, min_range_m));
  }
  if (!(max_elevation_deg >= min_elevation_deg)) {
    problems.push_back(fmt::format("max_elevation_deg ({}) must not be less than min_elevation_deg ({})",
                                   max_elevation_deg, min_elevation_deg));
  }
  const auto& beams = beam_elevations_deg;
  if (beams.empty()) return problems;
  if (beams.size() != static_cast<std::size_t>(rings)) {
    problems.push_back(
        fmt::format("beam_elevations_deg has {} entries, but rings is {}", beams.size(), rings));
  }
  if (std::adjacent_find(beams.begin(), beams.end(), std::less_equal<>()) != beams.end()) {
    problems.emplace_back("beam_elevations_deg must fall from the highest beam to the lowest");
  }
  return problems;
}

}  // namespace mlo
