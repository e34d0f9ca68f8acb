#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace mlo {

/// One return of a spinning lidar.
struct Point {
  /// Marks a point whose scan line is not known.
  static constexpr std::uint16_t kNoRing = 0xFFFF;

  Eigen::Vector3f p_lidar = Eigen::Vector3f::Zero();  ///< lidar frame [m]
  float intensity = 0.0F;                             ///< reflectance as the data has it, usually [0, 1]
  float sweep_fraction = 0.0F;                        ///< time within the sweep, 0 at its start, 1 at its end
  std::uint16_t ring = kNoRing;                       ///< scan line, 0 the highest beam
  static void archive(auto& self, auto& bytes) {      // core/archive.hpp
    bytes(self.p_lidar, self.intensity, self.sweep_fraction, self.ring);
  }
};

/// What one revolution of the lidar saw.
struct Scan {
  std::vector<Point> points;
  std::size_t frame = 0;        ///< number of the scan in its sequence, gaps included
  double stamp_s = 0.0;         ///< time of the pose that is asked for
  double stamp_fraction = 0.5;  ///< where in the sweep (0 start, 1 end) stamp_s lies
  double duration_s = 0.1;      ///< from the start of the sweep to its end
  /// True: the points are already where they would be had all been measured at stamp_s.
  bool motion_compensated = false;
};

/// What a point of the static map was taken for. The numbers are those in map files.
enum class MapLabel : std::uint8_t { unknown = 0, ground = 1, edge = 2, surface = 3, object = 4 };

/// One point of the static map.
struct MapPoint {
  Eigen::Vector3f p_map = Eigen::Vector3f::Zero();  ///< map frame [m]
  float intensity = 0.0F;                           ///< as in Point
  MapLabel label = MapLabel::unknown;
  static void archive(auto& self, auto& bytes) { bytes(self.p_map, self.intensity, self.label); }
};

}  // namespace mlo
