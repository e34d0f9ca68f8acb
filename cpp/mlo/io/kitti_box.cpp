#include "mlo/io/kitti_box.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

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

/// Grows with points of an image.
struct Extent {
  Eigen::Array2d min = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array2d max = -min;
  void add(const Eigen::Array2d& p) {
    min = min.min(p);
    max = max.max(p);
  }
};

/// Adds the ends of the part of an edge that lies in front of the camera.
void add_edge(Extent& extent, Eigen::Vector3d a, Eigen::Vector3d b, const Eigen::Matrix<double, 3, 4>& P2) {
  if (a.z() > b.z()) std::swap(a, b);
  if (b.z() < kNearPlane_m) return;
  if (a.z() < kNearPlane_m) a += (kNearPlane_m - a.z()) / (b.z() - a.z()) * (b - a);
  for (const Eigen::Vector3d& p_camera : {a, b}) {
    const Eigen::Vector3d p = P2 * p_camera.homogeneous();
    extent.add(p.head<2>().array() / p.z());
  }
}

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
  Extent extent;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (const std::size_t bit : {1U, 2U, 4U}) {
      if ((i & bit) == 0) add_edge(extent, corners[i], corners[i | bit], P2);
    }
  }
  const Eigen::Array2d last = image_size_px.array() - 1.0;
  if (!((extent.min < last).all() && (extent.max > 0.0).all())) return std::nullopt;
  const Eigen::Array2d min = extent.min.max(0.0);
  const Eigen::Array2d max = extent.max.min(last);
  return Box2d{min.x(), min.y(), max.x(), max.y()};
}

}  // namespace mlo
