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

SensorConfig hdl64e() {
  SensorConfig sensor;
  sensor.name = "hdl64e";
  sensor.rings = 64;
  for (int ring = 0; ring < 32; ++ring) sensor.beam_elevations_deg.push_back(2.0 - ring / 3.0);
  for (int ring = 0; ring < 32; ++ring) sensor.beam_elevations_deg.push_back(-8.83 - 0.5 * ring);
  sensor.max_elevation_deg = sensor.beam_elevations_deg.front();
  sensor.min_elevation_deg = sensor.beam_elevations_deg.back();
  sensor.rate_hz = 10.0;
  sensor.clockwise = true;
  sensor.start_azimuth_deg = 180.0;
  sensor.min_range_m = 2.7;
  sensor.max_range_m = 120.0;
  // Bias of the vertical angles in all of KITTI's scans (Deschaud, IMLS-SLAM, ICRA 2018).
  sensor.vertical_correction_deg = 0.205;
  return sensor;
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
