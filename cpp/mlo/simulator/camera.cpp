#include "mlo/simulator/camera.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "mlo/simulator/angles.hpp"

namespace mlo::simulator {
namespace {

constexpr double kNear_m = 0.3;  // the part of a box behind this plane is cut off before it is projected

std::vector<Eigen::Vector3d> corners_camera(const Rig& rig, const Box3d& box) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d sign((i & 1) ? 0.5 : -0.5, (i & 2) ? 0.5 : -0.5, (i & 4) ? 0.5 : -0.5);
    corners.push_back(rig.T_camera_lidar * (box.T_lidar_object() * sign.cwiseProduct(box.size_lwh_m)));
  }
  return corners;
}

/// The corners in front of the near plane, and the points where edges cross it.
std::vector<Eigen::Vector3d> cut_at_near_plane(const std::vector<Eigen::Vector3d>& corners) {
  std::vector<Eigen::Vector3d> visible;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i].z() >= kNear_m) visible.push_back(corners[i]);
    for (const std::size_t bit : {1U, 2U, 4U}) {
      const std::size_t j = i | bit;
      if (j == i || (corners[i].z() < kNear_m) == (corners[j].z() < kNear_m)) continue;
      const double share = (kNear_m - corners[i].z()) / (corners[j].z() - corners[i].z());
      visible.push_back(corners[i] + share * (corners[j] - corners[i]));
    }
  }
  return visible;
}

double area(const Box2d& box) {
  return std::max(0.0, box.right_px - box.left_px) * std::max(0.0, box.bottom_px - box.top_px);
}

std::string matrix_row(const Eigen::Matrix<double, 3, 4>& matrix) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      text += fmt::format("{}{:.12e}", text.empty() ? "" : " ", matrix(row, column));
    }
  }
  return text;
}

std::string projections(const Rig& rig) {
  std::string text;
  for (int camera = 0; camera < 4; ++camera)
    text += fmt::format("P{}: {}\n", camera, matrix_row(rig.projection()));
  return text;
}

}  // namespace

Rig::Rig() {
  Eigen::Matrix3d axes;  // camera from lidar: right = -y, down = -z, ahead = x
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Eigen::Quaterniond tilt = so3_exp({0.012, -0.008, 0.005});
  T_camera_lidar = {tilt * Eigen::Quaterniond(axes), {0.0, -0.08, -0.27}};
  T_imu_lidar = {so3_exp({0.005, -0.003, 0.002}), {0.8, -0.3, 0.8}};
}

Eigen::Matrix<double, 3, 4> Rig::projection() const {
  Eigen::Matrix<double, 3, 4> P = Eigen::Matrix<double, 3, 4>::Zero();
  P << focal_px, 0, center_u_px, 0, 0, focal_px, center_v_px, 0, 0, 0, 1, 0;
  return P;
}

std::optional<ImageView> project(const Rig& rig, const Box3d& box_lidar) {
  const std::vector<Eigen::Vector3d> points = cut_at_near_plane(corners_camera(rig, box_lidar));
  if (points.empty()) return std::nullopt;
  Box2d full{1e9, 1e9, -1e9, -1e9};
  for (const Eigen::Vector3d& p : points) {
    const double u = rig.focal_px * p.x() / p.z() + rig.center_u_px;
    const double v = rig.focal_px * p.y() / p.z() + rig.center_v_px;
    full = {std::min(full.left_px, u), std::min(full.top_px, v), std::max(full.right_px, u),
            std::max(full.bottom_px, v)};
  }
  const double right = rig.image_width_px - 1.0;
  const double bottom = rig.image_height_px - 1.0;
  const Box2d clipped{std::clamp(full.left_px, 0.0, right), std::clamp(full.top_px, 0.0, bottom),
                      std::clamp(full.right_px, 0.0, right), std::clamp(full.bottom_px, 0.0, bottom)};
  if (area(clipped) <= 0.0) return std::nullopt;
  return ImageView{clipped, 1.0 - area(clipped) / area(full)};
}

CameraBox camera_box(const Rig& rig, const Box3d& box_lidar) {
  const Eigen::Vector3d bottom =
      box_lidar.center_lidar_m - Eigen::Vector3d(0, 0, 0.5 * box_lidar.size_lwh_m.z());
  const Eigen::Vector3d heading(std::cos(box_lidar.yaw_rad), std::sin(box_lidar.yaw_rad), 0.0);
  const Eigen::Vector3d heading_camera = rig.T_camera_lidar.rotation() * heading;
  CameraBox box;
  box.bottom_camera_m = rig.T_camera_lidar * bottom;
  box.rotation_y_rad = std::atan2(-heading_camera.z(), heading_camera.x());
  box.alpha_rad =
      wrapped_rad(box.rotation_y_rad - std::atan2(box.bottom_camera_m.x(), box.bottom_camera_m.z()));
  return box;
}

std::string tracking_calibration(const Rig& rig) {
  return projections(rig) +
         fmt::format("R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: {}\nTr_imu_to_velo: {}\n",
                     kitti_row(rig.T_camera_lidar), kitti_row(rig.T_imu_lidar.inverse()));
}

std::string odometry_calibration(const Rig& rig) {
  return projections(rig) + fmt::format("Tr: {}\n", kitti_row(rig.T_camera_lidar));
}

std::string kitti_row(const SE3& pose) {
  return matrix_row(pose.matrix().topRows<3>());
}

}  // namespace mlo::simulator
