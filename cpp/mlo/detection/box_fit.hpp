#pragma once

#include <span>

#include <Eigen/Core>

namespace mlo {

/// Rectangle around points seen from above.
struct FittedRectangle {
  double yaw_rad = 0.0;                             ///< of its first axis, in [0, pi/2)
  Eigen::Vector2d min_m = Eigen::Vector2d::Zero();  ///< smallest coordinates along both axes
  Eigen::Vector2d max_m = Eigen::Vector2d::Zero();  ///< largest
  double mean_distance_m = 0.0;  ///< of the points from the nearer one of the two sides that they lie at

  Eigen::Vector2d extent_m() const { return max_m - min_m; }
};

/// Fits a rectangle to points on the sides of an object that face the lidar, by search over the heading with
/// the closeness criterion (Zhang et al., IV 2017): most points shall be close to one of two adjacent sides.
/// @param points  at least one
FittedRectangle fit_rectangle(std::span<const Eigen::Vector2f> points);

}  // namespace mlo
