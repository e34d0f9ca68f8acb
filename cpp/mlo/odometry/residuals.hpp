#pragma once

#include <optional>

#include <Eigen/Core>

namespace mlo {

/// A line of the previous scan in its lidar frame, with two directions across it.
struct Line {
  Eigen::Vector3d m;  ///< a point on it [m]
  /// Columns: two unit vectors, perpendicular to the line and to each other.
  Eigen::Matrix<double, 3, 2> across;
};

/// A plane of the previous scan in its lidar frame.
struct Plane {
  Eigen::Vector3d m;       ///< a point on it [m]
  Eigen::Vector3d normal;  ///< unit
};

/// The line through two points; nothing when they are nearer than min_baseline_m or equal.
std::optional<Line> line_through(const Eigen::Vector3d& m, const Eigen::Vector3d& n, double min_baseline_m);

/// The plane through three points; nothing when a height of their triangle is below min_height_m or zero.
std::optional<Plane> plane_through(const Eigen::Vector3d& m, const Eigen::Vector3d& n,
                                   const Eigen::Vector3d& o, double min_height_m);

/// A residual [m] of a placed point and its derivative by the left perturbation exp([t, w]) of its placing.
template <int Rows>
struct Residual {
  Eigen::Matrix<double, Rows, 1> value;
  Eigen::Matrix<double, Rows, 6> jacobian;
};

/// Eq. (3) as the vector from the line to the point in the line's two perpendicular directions: its length is
/// the distance, and unlike the distance it has a derivative everywhere.
Residual<2> point_to_line(const Eigen::Vector3d& p, const Line& line);

/// Eq. (4) with its sign: the distance along the plane's normal.
Residual<1> point_to_plane(const Eigen::Vector3d& p, const Plane& plane);

}  // namespace mlo
