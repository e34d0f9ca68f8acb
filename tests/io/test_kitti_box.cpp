#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "mlo/io/kitti_box.hpp"

namespace mlo {
namespace {

constexpr double kPi = std::numbers::pi;

/// Camera at the lidar's place: x right, y down, z ahead.
SE3 plain_camera() {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return SE3::from_matrix(T);
}

/// The same, mounted elsewhere and tilted by about a degree, as on a real car.
SE3 tilted_camera() {
  SE3::Tangent xi;
  xi << 0.01, -0.07, -0.27, 0.015, -0.01, 0.012;
  return SE3::exp(xi) * plain_camera();
}

Eigen::Matrix<double, 3, 4> camera_matrix() {
  Eigen::Matrix<double, 3, 4> P;
  P << 700.0, 0.0, 600.0, 0.0, 0.0, 700.0, 200.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  return P;
}

TEST(KittiBox, KnownBoxes) {
  // 10 m ahead, 2 m to the left, bottom 1.7 m below the camera; heading right, that is along the lidar's -y
  const Box3d right = box_in_lidar({{-2.0, 1.7, 10.0}, 1.5, 1.8, 4.0, 0.0}, plain_camera());
  EXPECT_TRUE(right.center_lidar_m.isApprox(Eigen::Vector3d(10.0, 2.0, -0.95), 1e-12));
  EXPECT_EQ(right.size_lwh_m, Eigen::Vector3d(4.0, 1.8, 1.5));
  EXPECT_NEAR(right.yaw_rad, -kPi / 2.0, 1e-12);
  // rotation_y of -pi/2 looks ahead
  EXPECT_NEAR(box_in_lidar({{0.0, 1.7, 10.0}, 1.5, 1.8, 4.0, -kPi / 2.0}, plain_camera()).yaw_rad, 0.0,
              1e-12);
  EXPECT_NEAR(box_in_lidar({{0.0, 1.7, 10.0}, 1.5, 1.8, 4.0, -3.0 * kPi / 4.0}, plain_camera()).yaw_rad,
              kPi / 4.0, 1e-12);
}

TEST(KittiBox, ThereAndBackGivesTheSameNumbers) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    const KittiBox box{{30.0 * uniform(rng), 2.0 * uniform(rng), 40.0 * uniform(rng)},
                       2.0 + uniform(rng),
                       2.0 + uniform(rng),
                       5.0 + uniform(rng),
                       kPi * uniform(rng)};
    const KittiBox back = box_in_camera(box_in_lidar(box, tilted_camera()), tilted_camera());
    EXPECT_LT((back.bottom_camera0_m - box.bottom_camera0_m).norm(), 1e-12);
    EXPECT_EQ(back.length_m, box.length_m);
    EXPECT_EQ(back.width_m, box.width_m);
    EXPECT_EQ(back.height_m, box.height_m);
    EXPECT_NEAR(back.rotation_y_rad, box.rotation_y_rad, 1e-12);
  }
}

TEST(KittiBox, RotationAndObservationAngleAreWrapped) {
  const Box3d box{{10.0, 0.0, 0.0}, {4.0, 2.0, 1.5}, 20.0 * kPi};
  EXPECT_NEAR(box_in_camera(box, plain_camera()).rotation_y_rad, -kPi / 2.0, 1e-9);
  KittiBox aside{{10.0, 0.0, 10.0}, 1.5, 2.0, 4.0, -3.0};
  EXPECT_NEAR(observation_angle_rad(aside), -3.0 - kPi / 4.0 + 2.0 * kPi, 1e-12);
  aside.rotation_y_rad = -3.0 * kPi / 4.0;
  EXPECT_NEAR(observation_angle_rad(aside), kPi, 1e-12);
}

TEST(KittiBox, ProjectionOfAKnownBox) {
  const KittiBox box{{0.0, 1.0, 11.0}, 2.0, 2.0, 2.0, 0.0};  // a cube whose near face is 10 m ahead
  const auto image = project_box(box, camera_matrix(), {1200.0, 400.0});
  ASSERT_TRUE(image.has_value());
  EXPECT_NEAR(image->left_px, 530.0, 1e-9);
  EXPECT_NEAR(image->right_px, 670.0, 1e-9);
  EXPECT_NEAR(image->top_px, 130.0, 1e-9);
  EXPECT_NEAR(image->bottom_px, 270.0, 1e-9);
}

TEST(KittiBox, ProjectionEndsAtTheImage) {
  const Eigen::Vector2d size_px(1200.0, 400.0);
  const auto left = project_box({{-9.0, 1.0, 11.0}, 2.0, 2.0, 4.0, 0.0}, camera_matrix(), size_px);
  ASSERT_TRUE(left.has_value());
  EXPECT_EQ(left->left_px, 0.0);
  // beside the camera and reaching behind it: what is in front still covers the image's right edge
  const auto beside = project_box({{2.0, 1.0, 1.0}, 2.0, 2.0, 6.0, kPi / 2.0}, camera_matrix(), size_px);
  ASSERT_TRUE(beside.has_value());
  EXPECT_EQ(beside->right_px, 1199.0);
  EXPECT_NEAR(beside->top_px, 0.0, 1e-9);
  EXPECT_EQ(beside->bottom_px, 399.0);
  EXPECT_NEAR(beside->left_px, 600.0 + 700.0 * 1.0 / 4.0, 1e-9);
}

TEST(KittiBox, PartsOutsideTheImageDoNotStretchWhatIsInside) {
  const Eigen::Vector2d size_px(1200.0, 400.0);
  // A long box along the road that begins beside the camera: its near end is large, and left of the image.
  const KittiBox box{{-5.0, 1.0, 8.0}, 1.0, 1.0, 12.0, kPi / 2.0};
  const auto image = project_box(box, camera_matrix(), size_px);
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->left_px, 0.0);
  EXPECT_NEAR(image->right_px, 600.0 - 700.0 * 4.5 / 14.0, 1e-9);
  // The right side leaves the image at x / z = -600 / 700, so at 4.5 m to the left at a depth of 5.25 m; its
  // bottom is 1 m below the camera there.
  EXPECT_NEAR(image->bottom_px, 200.0 + 700.0 * 1.0 / 5.25, 1e-9);
}

TEST(KittiBox, WhatIsNotInTheImageHasNoProjection) {
  const Eigen::Vector2d size_px(1200.0, 400.0);
  const KittiBox behind{{0.0, 1.0, -10.0}, 2.0, 2.0, 2.0, 0.0};
  const KittiBox far_left{{-50.0, 1.0, 10.0}, 2.0, 2.0, 2.0, 0.0};
  const KittiBox not_a_number{{std::nan(""), 1.0, 10.0}, 2.0, 2.0, 2.0, 0.0};
  EXPECT_FALSE(project_box(behind, camera_matrix(), size_px).has_value());
  EXPECT_FALSE(project_box(far_left, camera_matrix(), size_px).has_value());
  EXPECT_FALSE(project_box(not_a_number, camera_matrix(), size_px).has_value());
}

}  // namespace
}  // namespace mlo
