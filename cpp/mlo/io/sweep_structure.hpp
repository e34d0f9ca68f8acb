#pragma once

#include <span>
#include <string>
#include <vector>

#include "mlo/core/sensor.hpp"
#include "mlo/core/types.hpp"

namespace mlo {

/// What was found out about the scan lines of a point list.
struct RingRecovery {
  bool recovered = false;            ///< false: every ring was left at Point::kNoRing
  std::string problem;               ///< why not; empty when recovered
  std::size_t rings = 0;             ///< scan lines found
  bool monotone_elevations = false;  ///< mean elevation falls from each ring to the next
  double corrected_share = 0.0;  ///< share of points whose ring, by azimuth alone, the elevation corrected
  std::vector<double> elevation_deg;  ///< mean elevation of each ring found, highest first
};

/// Sets the ring of each point of a file that lists its scan lines one after the other: lines end where the
/// azimuth comes round to where the first one began (any cut, both directions, highest or lowest line first),
/// and the vertical angle must agree: it moves a line's end that the azimuth misplaces, joins lines split by
/// mistake, and tells which lines are absent. Neither is trusted alone; where they disagree nothing is
/// recovered. Coordinates must be finite.
/// @param sensor  its number of rings and their elevations; with rings = 0 lines are numbered as found
RingRecovery recover_rings(std::span<Point> points, const SensorConfig& sensor);

/// Makes rings that came with the points count from the highest line: they are kept, or turned round, if
/// their mean elevations are sorted, and numbered by elevation if not (some drivers number lasers, not
/// lines).
/// @param sensor  its number of rings, to turn them round; with rings = 0 the highest number present
/// @return false, with all rings at Point::kNoRing, if there are not two or more different ones
bool order_rings(std::span<Point> points, const SensorConfig& sensor);

/// Sets the sweep fraction of each point from its azimuth, by where the sweep begins and which way it turns.
void recover_sweep_fractions(std::span<Point> points, const SensorConfig& sensor);

/// Turns each point upwards in its vertical plane (about p x z) by the angle, keeping its range: undoes a
/// constant bias of the elevations (0.205 degrees for KITTI; Deschaud, IMLS-SLAM, ICRA 2018). Points on the z
/// axis stay.
void correct_vertical_angle(std::span<Point> points, double degrees);

}  // namespace mlo
