#include "mlo/detection/box_fit.hpp"

#include <cmath>
#include <numbers>

namespace mlo {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr int kCoarseStep_deg = 6;
constexpr int kFineStep_deg = 1;
// Nearer points count no more than at this distance: the noise of the lidar [m].
constexpr float kClosest_m = 0.05F;

using Row = Eigen::Array<float, 1, Eigen::Dynamic>;

// Distances from that one of the two ends of their range to which the points are nearer as a whole.
Row distances_to_side(const Row& along) {
  const Row to_max = along.maxCoeff() - along;
  const Row to_min = along - along.minCoeff();
  return to_max.square().sum() < to_min.square().sum() ? to_max : to_min;
}

Row distances_to_sides(const Eigen::Array2Xf& points, double yaw_rad, Row& first, Row& second) {
  const auto c = static_cast<float>(std::cos(yaw_rad));
  const auto s = static_cast<float>(std::sin(yaw_rad));
  first = c * points.row(0) + s * points.row(1);
  second = c * points.row(1) - s * points.row(0);
  return distances_to_side(first).min(distances_to_side(second));
}

float closeness(const Eigen::Array2Xf& points, double yaw_rad) {
  Row first;
  Row second;
  return distances_to_sides(points, yaw_rad, first, second).max(kClosest_m).inverse().sum();
}

}  // namespace

FittedRectangle fit_rectangle(std::span<const Eigen::Vector2f> points) {
  // about the first one, so that single precision suffices
  const Eigen::Vector2f& origin = points.front();
  Eigen::Array2Xf local(2, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    local.col(static_cast<Eigen::Index>(i)) = (points[i] - origin).array();
  }
  int best_deg = 0;
  float best = -1.0F;
  const auto look_at = [&](int yaw_deg) {
    const float value = closeness(local, yaw_deg * kRadPerDeg);
    if (value <= best) return;
    best = value;
    best_deg = yaw_deg;
  };
  for (int yaw_deg = 0; yaw_deg < 90; yaw_deg += kCoarseStep_deg) look_at(yaw_deg);
  const int coarse_deg = best_deg;
  for (int off = 1 - kCoarseStep_deg; off < kCoarseStep_deg; off += kFineStep_deg) look_at(coarse_deg + off);

  FittedRectangle rectangle;
  rectangle.yaw_rad = ((best_deg + 90) % 90) * kRadPerDeg;
  Row first;
  Row second;
  rectangle.mean_distance_m =
      static_cast<double>(distances_to_sides(local, rectangle.yaw_rad, first, second).mean());
  const double c = std::cos(rectangle.yaw_rad);
  const double s = std::sin(rectangle.yaw_rad);
  const Eigen::Vector2d shift(c * static_cast<double>(origin.x()) + s * static_cast<double>(origin.y()),
                              c * static_cast<double>(origin.y()) - s * static_cast<double>(origin.x()));
  rectangle.min_m = shift + Eigen::Vector2d(first.minCoeff(), second.minCoeff());
  rectangle.max_m = shift + Eigen::Vector2d(first.maxCoeff(), second.maxCoeff());
  return rectangle;
}

}  // namespace mlo
