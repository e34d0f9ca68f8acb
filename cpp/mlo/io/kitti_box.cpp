#include "mlo/io/kitti_box.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace mlo {
namespace {

constexpr double kNearPlane_m = 0.1;  // projection begins here

/// (-pi, pi]
double wrapped(double angle_rad) {
  const double turns = std::ceil((angle_rad - std::numbers::pi) / (2.0 * std::numbers::pi));
  return angle_rad - 2.0 * std::numbers::pi * turns;
}

Eigen::Vector3d heading_camera(double rotation_y_rad) {
  return {std::cos(rotation_y_rad), 0.0, -std::sin(rotation_y_rad)};
}

/// Bit 0 of the index: ahead or behind; bit 1: one side or the other; bit 2: top or bottom.
std::array<Eigen::Vector3d, 8> corners_camera(const KittiBox& box) {
  const Eigen::Vector3d ahead = heading_camera(box.rotation_y_rad);
  const Eigen::Vector3d aside(-ahead.z(), 0.0, ahead.x());
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double along = (i & 1U) != 0 ? 0.5 : -0.5;
    const double across = (i & 2U) != 0 ? 0.5 : -0.5;
    const double up_m = (i & 4U) != 0 ? box.height_m : 0.0;
    corners[i] = box.bottom_camera0_m + along * box.length_m * ahead + across * box.width_m * aside -
                 up_m * Eigen::Vector3d::UnitY();
  }
  return corners;
}

/// What is in the image lies on the positive side: n . q + d >= 0 of homogeneous image coordinates q = [u z;
/// v z; z].
struct HalfSpace {
  Eigen::Vector3d n;
  double d = 0.0;
  double side(const Eigen::Vector3d& q) const { return n.dot(q) + d; }
};

/// @param last_px  of each row and column
std::array<HalfSpace, 5> view_pyramid(const Eigen::Array2d& last_px) {
  return {{{{0.0, 0.0, 1.0}, -kNearPlane_m},
           {{1.0, 0.0, 0.0}},
           {{0.0, 1.0, 0.0}},
           {{-1.0, 0.0, last_px.x()}},
           {{0.0, -1.0, last_px.y()}}}};
}

using Polygon = std::vector<Eigen::Vector3d>;

/// The part of a convex polygon on the positive side (Sutherland and Hodgman, CACM 1974).
Polygon cut(const Polygon& polygon, const HalfSpace& half_space) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& a = polygon[i];
    const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
    const double side_a = half_space.side(a);
    const double side_b = half_space.side(b);
    if (side_a >= 0.0) kept.push_back(a);
    if ((side_a >= 0.0) != (side_b >= 0.0)) kept.emplace_back(a + side_a / (side_a - side_b) * (b - a));
  }
  return kept;
}

/// Indices of corners_camera, each face once round.
constexpr std::array<std::array<std::size_t, 4>, 6> kFaces{
    {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};

}  // namespace

Box3d box_in_lidar(const KittiBox& box, const SE3& T_camera0_lidar) {
  const SE3 T_lidar_camera0 = T_camera0_lidar.inverse();
  const Eigen::Vector3d center_camera = box.bottom_camera0_m - 0.5 * box.height_m * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d heading = T_lidar_camera0.rotation() * heading_camera(box.rotation_y_rad);
  return {T_lidar_camera0 * center_camera,
          {box.length_m, box.width_m, box.height_m},
          std::atan2(heading.y(), heading.x())};
}

KittiBox box_in_camera(const Box3d& box, const SE3& T_camera0_lidar) {
  KittiBox result;
  result.length_m = box.size_lwh_m.x();
  result.width_m = box.size_lwh_m.y();
  result.height_m = box.size_lwh_m.z();
  result.bottom_camera0_m =
      T_camera0_lidar * box.center_lidar_m + 0.5 * result.height_m * Eigen::Vector3d::UnitY();
  // The heading lies in the camera's x-z plane and is perpendicular to the left side of the box in the lidar
  // frame: not the mere projection of the heading, so that box_in_lidar gives the same yaw again.
  const Eigen::Vector3d left_lidar(-std::sin(box.yaw_rad), std::cos(box.yaw_rad), 0.0);
  const Eigen::Vector3d left = T_camera0_lidar.rotation() * left_lidar;
  const Eigen::Vector3d heading_lidar(std::cos(box.yaw_rad), std::sin(box.yaw_rad), 0.0);
  const double ry = std::atan2(left.x(), left.z());
  const bool same_way = heading_camera(ry).dot(T_camera0_lidar.rotation() * heading_lidar) > 0.0;
  result.rotation_y_rad = wrapped(same_way ? ry : ry + std::numbers::pi);
  return result;
}

double observation_angle_rad(const KittiBox& box) {
  return wrapped(box.rotation_y_rad - std::atan2(box.bottom_camera0_m.x(), box.bottom_camera0_m.z()));
}

std::optional<Box2d> project_box(const KittiBox& box, const Eigen::Matrix<double, 3, 4>& P2,
                                 const Eigen::Vector2d& image_size_px) {
  const std::array<Eigen::Vector3d, 8> corners = corners_camera(box);
  const Eigen::Array2d last_px = image_size_px.array() - 1.0;
  Eigen::Array2d min_px = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array2d max_px = -min_px;
  for (const std::array<std::size_t, 4>& face : kFaces) {
    Polygon polygon;
    for (const std::size_t i : face) polygon.emplace_back(P2 * corners[i].homogeneous());
    for (const HalfSpace& half_space : view_pyramid(last_px)) polygon = cut(polygon, half_space);
    for (const Eigen::Vector3d& q : polygon) {
      min_px = min_px.min(q.head<2>().array() / q.z());
      max_px = max_px.max(q.head<2>().array() / q.z());
    }
  }
  if (!((min_px < last_px).all() && (max_px > 0.0).all())) return std::nullopt;
  // Cut points lie on the border but for rounding.
  min_px = min_px.max(0.0);
  max_px = max_px.min(last_px);
  return Box2d{min_px.x(), min_px.y(), max_px.x(), max_px.y()};
}

}  // namespace mlo
