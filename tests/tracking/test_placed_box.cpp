#include <numbers>

#include <gtest/gtest.h>

#include "mlo/tracking/placed_box.hpp"
#include "tracking/boxes.hpp"

namespace mlo {
namespace {

using test::car_box;
using test::kDegree;
using test::placed_car;

TEST(PlacedBox, GoesToTheOdometryFrameAndBack) {
  const SE3 T_map_lidar(so3_exp({0.02, -0.01, 2.0}), {10.0, -5.0, 0.3});
  const Box3d box = car_box(20.0, 3.0, 170.0 * kDegree);
  const PlacedBox placed = place(box, T_map_lidar);
  EXPECT_TRUE(placed.center_map_m.isApprox(T_map_lidar * box.center_lidar_m, 1e-12));
  const Box3d back = in_lidar(placed, T_map_lidar);
  EXPECT_TRUE(back.center_lidar_m.isApprox(box.center_lidar_m, 1e-12));
  // Boxes stay upright in both frames: exact up to the second order of the tilt.
  EXPECT_NEAR(wrapped_angle(back.yaw_rad - box.yaw_rad), 0.0, 1e-3);
}

TEST(PlacedBox, WrapsAngles) {
  constexpr double kPi = std::numbers::pi;
  EXPECT_DOUBLE_EQ(wrapped_angle(0.5), 0.5);
  EXPECT_DOUBLE_EQ(wrapped_angle(kPi), kPi);
  EXPECT_NEAR(wrapped_angle(-kPi), kPi, 1e-12);
  EXPECT_NEAR(wrapped_angle(7.0 * kPi + 0.1), -kPi + 0.1, 1e-12);
}

TEST(PlacedBox, OverlapOfFootprints) {
  const PlacedBox car = placed_car(10.0, 0.0);
  EXPECT_DOUBLE_EQ(footprint_overlap(car, car), 1.0);
  EXPECT_NEAR(footprint_overlap(car, placed_car(12.0, 0.0)), 0.5, 0.05);
  EXPECT_EQ(footprint_overlap(car, placed_car(10.0, 2.0)), 0.0) << "side by side, 0.4 m apart";
  EXPECT_EQ(footprint_overlap(car, placed_car(100.0, 0.0)), 0.0);
  // Crosswise, a car's width of its length is shared.
  EXPECT_NEAR(footprint_overlap(car, placed_car(10.0, 0.0, 90.0 * kDegree)), 1.6 / 4.0, 0.05);
  PlacedBox pedestrian = car;
  pedestrian.size_lwh_m = {0.6, 0.6, 1.7};
  EXPECT_DOUBLE_EQ(footprint_overlap(car, pedestrian), 1.0) << "of the smaller one's area";
  EXPECT_DOUBLE_EQ(footprint_overlap(pedestrian, car), 1.0);
}

}  // namespace
}  // namespace mlo
