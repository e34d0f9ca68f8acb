#include "mlo/tracking/placed_box.hpp"

#include <cmath>
#include <numbers>

namespace mlo {
namespace {

double rotated_yaw(double yaw_rad, const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d heading = rotation * Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
  return std::atan2(heading.y(), heading.x());
}

}  // namespace

PlacedBox place(const Box3d& box, const SE3& T_map_lidar) {
  return {T_map_lidar * box.center_lidar_m, box.size_lwh_m, rotated_yaw(box.yaw_rad, T_map_lidar.rotation())};
}

Box3d in_lidar(const PlacedBox& box, const SE3& T_map_lidar) {
  const SE3 T_lidar_map = T_map_lidar.inverse();
  return {T_lidar_map * box.center_map_m, box.size_lwh_m, rotated_yaw(box.yaw_rad, T_lidar_map.rotation())};
}

double wrapped_angle(double angle_rad) {
  const double turns = std::ceil((angle_rad - std::numbers::pi) / (2.0 * std::numbers::pi));
  return angle_rad - 2.0 * std::numbers::pi * turns;
}

double footprint_overlap(const PlacedBox& a, const PlacedBox& b) {
  const double reach_m = 0.5 * (a.size_lwh_m.head<2>().norm() + b.size_lwh_m.head<2>().norm());
  if ((a.center_map_m - b.center_map_m).head<2>().norm() > reach_m) return 0.0;
  const bool a_smaller = a.size_lwh_m.x() * a.size_lwh_m.y() < b.size_lwh_m.x() * b.size_lwh_m.y();
  const PlacedBox& small = a_smaller ? a : b;
  const PlacedBox& large = a_smaller ? b : a;
  // A grid of sample points is good enough to tell neighbours from duplicates.
  constexpr int kAlong = 10;
  constexpr int kAcross = 6;
  const Eigen::Rotation2Dd rotation(small.yaw_rad - large.yaw_rad);
  const Eigen::Vector2d offset_m = Eigen::Rotation2Dd(-large.yaw_rad) *
                                   Eigen::Vector2d((small.center_map_m - large.center_map_m).head<2>());
  int inside = 0;
  for (int i = 0; i < kAlong * kAcross; ++i) {
    const Eigen::Vector2d p((i % kAlong + 0.5) / kAlong - 0.5, (i / kAlong + 0.5) / kAcross - 0.5);
    const Eigen::Vector2d q_m =
        offset_m + rotation * Eigen::Vector2d(p.cwiseProduct(small.size_lwh_m.head<2>()));
    if ((q_m.cwiseAbs().array() <= 0.5 * large.size_lwh_m.head<2>().array()).all()) ++inside;
  }
  return static_cast<double>(inside) / (kAlong * kAcross);
}

}  // namespace mlo
