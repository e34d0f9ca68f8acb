#pragma once

#include <vector>

#include <Eigen/Core>

namespace mlo::simulator {

struct PathPoint {
  Eigen::Vector2d p_world = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;  ///< not wrapped: continuous along the path
  double curvature_per_m = 0.0;

  Eigen::Vector2d ahead() const;
  Eigen::Vector2d left() const;
};

/// A piece of road of constant curvature (positive: to the left).
struct PathPiece {
  double length_m = 0.0;
  double curvature_per_m = 0.0;
};

/// A smooth planar curve by arc length. Beyond its ends it goes on straight.
class Path {
 public:
  Path() = default;
  /// Pieces one after the other; curvature changes gradually over ease_m, as a driver's steering does.
  Path(const PathPoint& start, const std::vector<PathPiece>& pieces, double ease_m);

  double length_m() const;
  PathPoint at(double s_m) const;
  /// The same curve shifted to the left.
  Path offset(double left_m) const;
  Path reversed() const;
  /// Part of the curve; may reach beyond its ends.
  Path part(double from_m, double to_m) const;

 private:
  static constexpr double kStep_m = 0.25;
  explicit Path(std::vector<PathPoint> samples);

  std::vector<PathPoint> samples_;
  std::vector<double> s_m_;
};

Path straight(const Eigen::Vector2d& from, double heading_rad, double length_m);

}  // namespace mlo::simulator
