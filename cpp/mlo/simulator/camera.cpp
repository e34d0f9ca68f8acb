#include "mlo/simulator/camera.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "mlo/io/kitti_box.hpp"
#include "mlo/io/trajectory_file.hpp"

namespace mlo::simulator {
namespace {

double area(const Box2d& box) {
  return std::max(0.0, box.right_px - box.left_px) * std::max(0.0, box.bottom_px - box.top_px);
}

std::string projections(const Rig& rig) {
  std::string text;
  const Eigen::Matrix<double, 3, 4> P = rig.projection();
  for (int camera = 0; camera < 4; ++camera) {
    text += fmt::format("P{}:", camera);
    for (int i = 0; i < 12; ++i) text += fmt::format(" {:.12e}", P(i / 4, i % 4));
    text += "\n";
  }
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
  const KittiBox box = box_in_camera(box_lidar, rig.T_camera_lidar);
  const std::optional<Box2d> clipped =
      project_box(box, rig.projection(), {rig.image_width_px, rig.image_height_px});
  if (!clipped || area(*clipped) <= 0.0) return std::nullopt;
  // the same with the image in the middle of a much larger one: what would be there without a border
  constexpr double kBorder_px = 1e5;
  Eigen::Matrix<double, 3, 4> P_large = rig.projection();
  P_large.topRows<2>() += kBorder_px * P_large.row(2).replicate<2, 1>();
  const std::optional<Box2d> whole = project_box(box, P_large, Eigen::Vector2d::Constant(2.0 * kBorder_px));
  return ImageView{*clipped, whole ? 1.0 - std::min(1.0, area(*clipped) / area(*whole)) : 0.0};
}

std::string tracking_calibration(const Rig& rig) {
  return projections(rig) +
         fmt::format("R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: {}\nTr_imu_to_velo: {}\n",
                     kitti_row(rig.T_camera_lidar), kitti_row(rig.T_imu_lidar.inverse()));
}

std::string odometry_calibration(const Rig& rig) {
  return projections(rig) + fmt::format("Tr: {}\n", kitti_row(rig.T_camera_lidar));
}

}  // namespace mlo::simulator
