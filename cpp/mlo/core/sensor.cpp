#include "mlo/core/sensor.hpp"

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

}  // namespace mlo
