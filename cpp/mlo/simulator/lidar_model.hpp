#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/fields.hpp"
#include "mlo/core/sensor.hpp"
#include "mlo/core/types.hpp"
#include "mlo/simulator/ray_world.hpp"
#include "mlo/simulator/scene.hpp"

namespace mlo::simulator {

/// How far the simulated lidar is from a perfect one.
struct LidarErrors {
  double range_noise_m = 0.024;  ///< standard deviation
  double max_range_m = 80.0;     ///< KITTI's scans end there
  double random_loss = 0.004;    ///< share of pulses lost for no reason
  /// Reflectance x distance law at which half of the pulses are lost; a larger value loses more of what is
  /// far, dark or seen at a grazing angle. 0: nothing is lost.
  double loss_level = 0.021;
  bool own_roof = true;  ///< the robot's roof hides part of the lowest beams, as on KITTI's car
  /// Elevations are reported too low by this much: KITTI's odometry scans have 0.205 [deg].
  double elevation_bias_deg = 0.0;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("range_noise_m", range_noise_m, between(0.0, 10.0), "standard deviation of the ranges [m]");
    visit("max_range_m", max_range_m, between(1.0, 1000.0), "no returns beyond; KITTI's end at 80 m [m]");
    visit("random_loss", random_loss, between(0.0, 1.0), "share of the pulses lost for no reason");
    visit("loss_level", loss_level, between(0.0, 10.0),
          "signal at which half of the pulses are lost: higher loses more of what is far, dark or grazing");
  }
};

/// One return with its truth.
struct SimulatedPoint {
  Point measured;                                     ///< in the lidar frame of its own time
  Eigen::Vector3f p_world = Eigen::Vector3f::Zero();  ///< true place, without noise [m]
  Surface surface = Surface::road;
  int object_id = 0;  ///< 0: static
};

/// A revolution: ring by ring, highest first, in each ring by azimuth growing from ahead (KITTI's order).
struct Sweep {
  double start_s = 0.0;
  double stamp_s = 0.0;  ///< when the beams pass straight ahead
  double end_s = 0.0;
  std::vector<SimulatedPoint> points;
};

/// Part of the sweep at which the beams point straight ahead.
double stamp_fraction(const SensorConfig& sensor);

/// Casts one revolution that starts at start_s. Same scene, seed and frame: same points, for any number of
/// threads.
Sweep scan(const Scene& scene, RayWorld& world, const SensorConfig& sensor, const LidarErrors& errors,
           double start_s, std::uint64_t frame, std::uint64_t seed);

}  // namespace mlo::simulator
