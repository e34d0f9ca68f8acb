#include "mlo/odometry/residuals.hpp"

#include <algorithm>

#include <Eigen/Geometry>

namespace mlo {
namespace {

// Derivative of direction . p by a left perturbation: [direction; p x direction].
Eigen::Matrix<double, 1, 6> gradient(const Eigen::Vector3d& p, const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 1, 6> row;
  row << direction.transpose(), p.cross(direction).transpose();
  return row;
}

}  // namespace

std::optional<Line> line_through(const Eigen::Vector3d& m, const Eigen::Vector3d& n, double min_baseline_m) {
  const Eigen::Vector3d d = n - m;
  const double length = d.norm();
  if (!(length >= min_baseline_m) || !(length > 0.0)) return std::nullopt;
  Line line;
  line.m = m;
  line.across.col(0) = d.unitOrthogonal();
  line.across.col(1) = (d / length).cross(line.across.col(0));
  return line;
}

std::optional<Plane> plane_through(const Eigen::Vector3d& m, const Eigen::Vector3d& n,
                                   const Eigen::Vector3d& o, double min_height_m) {
  const Eigen::Vector3d cross = (n - m).cross(o - m);
  const double double_area = cross.norm();
  const double longest = std::max({(n - m).norm(), (o - m).norm(), (o - n).norm()});
  if (!(double_area >= min_height_m * longest) || !(double_area > 0.0)) return std::nullopt;
  return Plane{m, cross / double_area};
}

Residual<2> point_to_line(const Eigen::Vector3d& p, const Line& line) {
  Residual<2> residual;
  residual.value = line.across.transpose() * (p - line.m);
  residual.jacobian.row(0) = gradient(p, line.across.col(0));
  residual.jacobian.row(1) = gradient(p, line.across.col(1));
  return residual;
}

Residual<1> point_to_plane(const Eigen::Vector3d& p, const Plane& plane) {
  Residual<1> residual;
  residual.value(0) = plane.normal.dot(p - plane.m);
  residual.jacobian = gradient(p, plane.normal);
  return residual;
}

}  // namespace mlo
