#pragma once

#include <string>
#include <vector>

#include "mlo/core/fields.hpp"

namespace mlo {

/// A spinning lidar. Used to recover rings and times that the data lacks, to crop by range, and to simulate.
struct SensorConfig {
  std::string name = "generic";
  int rings = 0;  ///< number of scan lines; 0 takes what the data says
  /// Elevation of each beam [deg], highest first; empty: evenly spaced between the two limits below.
  std::vector<double> beam_elevations_deg;
  double max_elevation_deg = 25.0;
  double min_elevation_deg = -25.0;
  double rate_hz = 10.0;
  bool clockwise = true;             ///< sense of rotation seen from above
  double start_azimuth_deg = 180.0;  ///< where a sweep begins; 0 is ahead (x), 90 left (y)
  int columns = 2048;                ///< firings per revolution (simulation only)
  double min_range_m = 1.0;
  double max_range_m = 120.0;
  double vertical_correction_deg =
      0.0;  ///< raises every point by this angle, against a bias of the elevations

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("name", name, Anything{}, "model, for reports");
    visit("rings", rings, between(0, 1024), "number of scan lines; 0 takes what the data says");
    visit("beam_elevations_deg", beam_elevations_deg, between(-90.0, 90.0),
          "elevation of each beam, highest first [deg]; empty: evenly spaced between the limits");
    visit("max_elevation_deg", max_elevation_deg, between(-90.0, 90.0), "highest beam [deg]");
    visit("min_elevation_deg", min_elevation_deg, between(-90.0, 90.0), "lowest beam [deg]");
    visit("rate_hz", rate_hz, between(0.1, 1000.0), "revolutions per second [Hz]");
    visit("clockwise", clockwise, Anything{}, "sense of rotation seen from above");
    visit("start_azimuth_deg", start_azimuth_deg, between(-360.0, 360.0),
          "azimuth at which a sweep begins [deg]: 0 ahead (x), 90 left (y)");
    visit("columns", columns, between(16, 16384), "firings per revolution (simulation only)");
    visit("min_range_m", min_range_m, between(0.0, 1000.0),
          "nearer points are dropped: the robot itself [m]");
    visit("max_range_m", max_range_m, between(1.0, 10000.0),
          "farther points are dropped: sparse and noisy [m]");
    visit("vertical_correction_deg", vertical_correction_deg, between(-5.0, 5.0),
          "raises every point by this angle, against a known bias of the elevations [deg]");
  }

  /// One elevation per ring [deg], highest first: the table, or evenly spaced; empty when rings is 0.
  std::vector<double> elevations_deg() const;

  /// What contradicts itself, one sentence each: limits in the wrong order, a beam table of another length
  /// than rings or not highest first.
  std::vector<std::string> find_problems() const;
};

/// Velodyne HDL-64E as KITTI mounts and runs it: nominal elevations (upper 32 beams 1/3 degree apart, lower
/// 32 half a degree), 10 Hz, clockwise from behind.
SensorConfig hdl64e();

}  // namespace mlo
