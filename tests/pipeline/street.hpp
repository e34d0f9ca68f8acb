#pragma once

#include <cstddef>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/sensor.hpp"
#include "mlo/core/types.hpp"
#include "mlo/pipeline/config.hpp"

namespace mlo::test {

/// An upright block with sides along the axes, standing on the ground (z = 0).
struct Block {
  Eigen::Vector3d min_world;
  Eigen::Vector3d max_world;
};

/// A street along x, with houses at different distances, posts and one parked car (the last block).
std::vector<Block> street_blocks();

/// A small lidar: 32 rings of 360 points, 10 Hz, clockwise from behind.
SensorConfig small_lidar();

/// The defaults with this lidar.
PipelineConfig street_config();

/// Lidar pose at a time in sweeps: 1.7 m above the street's ground, driving with constant motion.
SE3 street_pose(double sweeps);
/// The motion of one sweep.
SE3 street_motion();

/// The scan taken around a time in sweeps (its middle), line by line, stamped with 0.1 s a sweep.
/// @param motion_compensated  points are where they would be in the middle of the sweep
Scan street_scan(std::size_t frame, double sweeps, bool motion_compensated);

/// The parked car as a perfect detector finds it.
Detection parked_car(double sweeps);

}  // namespace mlo::test
