#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mlo/core/sensor.hpp"
#include "mlo/core/types.hpp"

namespace mlo::test {

/// How a synthetic sweep is stored.
struct SweepLayout {
  SensorConfig sensor;
  double cut_azimuth_deg = 0.0;   ///< where each line begins in the file
  bool counter_clockwise = true;  ///< order of the points of a line
  bool highest_first = true;      ///< order of the lines
  int columns = 900;
  double dropout = 0.1;         ///< share of points that are missing
  double azimuth_jitter = 0.0;  ///< of a column [columns], as motion compensation causes it
  std::vector<int> absent_rings = {};
};

/// What a lidar 1.7 m above flat ground sees in a 40 m x 12 m room, line by line, with the true ring in each
/// point. The beams leave 0.2 m above the origin, so that elevations depend on range as those of real lidars
/// do.
inline std::vector<Point> make_sweep(const SweepLayout& layout) {
  constexpr double kDegToRad = std::numbers::pi / 180.0;
  constexpr double kBeamHeight = 0.2;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const std::vector<double> elevations_deg = layout.sensor.elevations_deg();
  std::vector<Point> points;
  for (std::size_t line = 0; line < elevations_deg.size(); ++line) {
    const std::size_t ring = layout.highest_first ? line : elevations_deg.size() - 1 - line;
    const auto& absent = layout.absent_rings;
    if (std::find(absent.begin(), absent.end(), static_cast<int>(ring)) != absent.end()) continue;
    for (int column = 0; column < layout.columns; ++column) {
      if (uniform(random) < layout.dropout) continue;
      const double jitter = layout.azimuth_jitter * (uniform(random) - 0.5);
      const double along = (column + 0.5 + jitter) / layout.columns * 2.0 * std::numbers::pi;
      const double azimuth = layout.cut_azimuth_deg * kDegToRad + (layout.counter_clockwise ? along : -along);
      const double elevation = elevations_deg[ring] * kDegToRad;
      const double wall = std::min(20.0 / std::abs(std::cos(azimuth)), 6.0 / std::abs(std::sin(azimuth)));
      const double ground = elevation < 0.0 ? (1.7 + kBeamHeight) / std::tan(-elevation) : 1e9;
      const double radius = std::min(wall, ground);
      Point point;
      point.p_lidar = Eigen::Vector3d(radius * std::cos(azimuth), radius * std::sin(azimuth),
                                      kBeamHeight + radius * std::tan(elevation))
                          .cast<float>();
      point.ring = static_cast<std::uint16_t>(ring);
      points.push_back(point);
    }
  }
  return points;
}

/// The bytes of a .bin file with the points.
inline std::string to_bin(const std::vector<Point>& points) {
  std::string bytes;
  for (const Point& point : points) {
    const float record[4] = {point.p_lidar.x(), point.p_lidar.y(), point.p_lidar.z(), point.intensity};
    bytes.append(reinterpret_cast<const char*>(record), sizeof(record));
  }
  return bytes;
}

}  // namespace mlo::test
