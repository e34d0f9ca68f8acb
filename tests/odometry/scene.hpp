#pragma once

#include <cstdint>
#include <vector>

#include "mlo/core/features.hpp"
#include "mlo/core/sweep_motion.hpp"

namespace mlo::test {

/// A vertical wall from one ground point to another.
struct Wall {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
};

/// A world of flat ground at z = 0, walls and vertical posts of known place: what perception would find of it
/// is computed without perception.
struct Scene {
  std::vector<Wall> walls;
  std::vector<Eigen::Vector2d> posts;
};

/// How it is looked at.
struct View {
  SE3 T_world_lidar = {};       ///< at the reference time
  SE3 T_previous_current = {};  ///< motion over the sweep
  double reference_fraction = 0.5;
  bool motion_compensated = false;
  bool rings = true;
  double noise_m = 0.0;
  std::uint64_t seed = 1;  ///< of where on walls, posts and ground the points lie, and of the noise
};

/// The lidar 1.7 m above the ground, moved by a planar pose and a little tilt.
SE3 pose_above_ground(double x, double y, double yaw_rad, double roll_rad = 0.0, double pitch_rad = 0.0);

/// Features and candidates on everything within 40 m; a feature has smoothness 0.
Percept observe(const Scene& scene, const View& view);

/// A street with walls left and right that are not parallel throughout, a cross wall, and many posts.
Scene street();
/// Two endless parallel walls.
Scene corridor();

}  // namespace mlo::test
