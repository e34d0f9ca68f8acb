#include "mlo/core/box_overlap.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

namespace mlo {
namespace {

constexpr double kEmpty = std::numeric_limits<double>::epsilon();

double area(const Box2d& box) {
  return (box.right_px - box.left_px) * (box.bottom_px - box.top_px);
}

double intersection(const Box2d& a, const Box2d& b) {
  const double width = std::min(a.right_px, b.right_px) - std::max(a.left_px, b.left_px);
  const double height = std::min(a.bottom_px, b.bottom_px) - std::max(a.top_px, b.top_px);
  return std::max(width, 0.0) * std::max(height, 0.0);
}

using Polygon = std::vector<Eigen::Vector2d>;

// The part of a convex polygon where normal . p <= limit (Sutherland-Hodgman).
Polygon clipped(const Polygon& polygon, const Eigen::Vector2d& normal, double limit) {
  Polygon result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& p = polygon[i];
    const Eigen::Vector2d& q = polygon[(i + 1) % polygon.size()];
    const double p_beyond = normal.dot(p) - limit;
    const double q_beyond = normal.dot(q) - limit;
    if (p_beyond <= 0.0) result.push_back(p);
    if ((p_beyond < 0.0 && q_beyond > 0.0) || (p_beyond > 0.0 && q_beyond < 0.0)) {
      result.emplace_back(p + (q - p) * (p_beyond / (p_beyond - q_beyond)));
    }
  }
  return result;
}

double area(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& p = polygon[i];
    const Eigen::Vector2d& q = polygon[(i + 1) % polygon.size()];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return 0.5 * std::abs(twice);
}

// Area that two boxes share seen from above: b's outline in a's axes, cut off at a's four sides.
double footprint_intersection(const Box3d& a, const Box3d& b) {
  const double reach_m = 0.5 * (a.size_lwh_m.head<2>().norm() + b.size_lwh_m.head<2>().norm());
  const Eigen::Vector2d apart_m = (a.center_lidar_m - b.center_lidar_m).head<2>();
  if (apart_m.squaredNorm() > reach_m * reach_m) return 0.0;  // cheap, and true of most pairs
  const Eigen::Vector2d half = 0.5 * a.size_lwh_m.head<2>();
  const Eigen::Rotation2Dd R_ab(b.yaw_rad - a.yaw_rad);
  const Eigen::Vector2d center =
      Eigen::Rotation2Dd(-a.yaw_rad) * (b.center_lidar_m - a.center_lidar_m).head<2>().eval();
  Polygon outline;
  for (const auto& [x, y] : {std::pair{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}}) {
    outline.emplace_back(center + R_ab * Eigen::Vector2d(x * b.size_lwh_m.x(), y * b.size_lwh_m.y()));
  }
  for (int axis = 0; axis < 2; ++axis) {
    outline = clipped(outline, Eigen::Vector2d::Unit(axis), half(axis));
    outline = clipped(outline, -Eigen::Vector2d::Unit(axis), half(axis));
  }
  return area(outline);
}

}  // namespace

double intersection_over_union(const Box2d& a, const Box2d& b) {
  const double area_a = area(a);
  const double area_b = area(b);
  if (area_a <= kEmpty || area_b <= kEmpty) return 0.0;
  const double shared = intersection(a, b);
  return shared / (area_a + area_b - shared);
}

double footprint_iou(const Box3d& a, const Box3d& b) {
  if ((a.size_lwh_m.head<2>().array() <= 0.0).any() || (b.size_lwh_m.head<2>().array() <= 0.0).any()) {
    return 0.0;
  }
  const double shared = footprint_intersection(a, b);
  return shared / (a.size_lwh_m.head<2>().prod() + b.size_lwh_m.head<2>().prod() - shared);
}

double intersection_over_union(const Box3d& a, const Box3d& b) {
  if ((a.size_lwh_m.array() <= 0.0).any() || (b.size_lwh_m.array() <= 0.0).any()) return 0.0;
  const double half_a = 0.5 * a.size_lwh_m.z();
  const double half_b = 0.5 * b.size_lwh_m.z();
  const double height = std::min(a.center_lidar_m.z() + half_a, b.center_lidar_m.z() + half_b) -
                        std::max(a.center_lidar_m.z() - half_a, b.center_lidar_m.z() - half_b);
  if (height <= 0.0) return 0.0;
  const double shared = footprint_intersection(a, b) * height;
  return shared / (a.size_lwh_m.prod() + b.size_lwh_m.prod() - shared);
}

double covered_fraction(const Box2d& box, const Box2d& region) {
  const double box_area = area(box);
  return box_area <= kEmpty ? 0.0 : intersection(box, region) / box_area;
}

}  // namespace mlo
