#include <numbers>

#include <gtest/gtest.h>

#include "mlo/tracking/visibility.hpp"
#include "tracking/boxes.hpp"

namespace mlo {
namespace {

using test::car_box;
using test::kDegree;

TEST(Visibility, NearerBoxesHideFartherOnes) {
  const std::vector<Box3d> boxes{car_box(10.0, 0.0, 90.0 * kDegree), car_box(30.0, 0.0), car_box(30.0, 15.0)};
  const std::vector<double> shares = hidden_shares(boxes);
  EXPECT_EQ(shares[0], 0.0);
  EXPECT_DOUBLE_EQ(shares[1], 1.0);
  EXPECT_EQ(shares[2], 0.0);
}

TEST(Visibility, HalfHidden) {
  // The near box covers the azimuths left of straight ahead, where half of the far one lies.
  const std::vector<Box3d> boxes{{{10.0, 1.0, 0.0}, {0.01, 2.0, 1.5}, 0.0},
                                 {{30.0, 0.0, 0.0}, {0.01, 2.0, 1.5}, 0.0}};
  EXPECT_NEAR(hidden_shares(boxes)[1], 0.5, 1e-6);
}

TEST(Visibility, BehindTheSensorAzimuthsWrap) {
  const std::vector<Box3d> boxes{car_box(-10.0, 0.0, 90.0 * kDegree), car_box(-30.0, 0.0)};
  EXPECT_DOUBLE_EQ(hidden_shares(boxes)[1], 1.0);
}

TEST(Visibility, NothingAndOneBox) {
  EXPECT_TRUE(hidden_shares({}).empty());
  const std::vector<Box3d> one{car_box(10.0, 0.0)};
  EXPECT_EQ(hidden_shares(one), std::vector<double>{0.0});
}

TEST(Visibility, TheMarginIsThatOfTheOutermostCorner) {
  const Box3d ahead = car_box(20.0, 0.0);
  const Eigen::Vector3d half = 0.5 * ahead.size_lwh_m;
  const double corner_rad = std::atan2(half.y(), 20.0 - half.x());
  EXPECT_NEAR(field_of_view_margin_rad(car_box(20.0, 0.0), 80.0 * kDegree), 40.0 * kDegree - corner_rad,
              0.01);
  const double left = field_of_view_margin_rad(car_box(20.0, 5.0), 80.0 * kDegree);
  EXPECT_NEAR(field_of_view_margin_rad(car_box(20.0, -5.0), 80.0 * kDegree), left, 1e-12) << "either side";
  EXPECT_LT(field_of_view_margin_rad(car_box(20.0, 16.5), 80.0 * kDegree), 0.0)
      << "its centre is within, a corner is not";
  EXPECT_LT(field_of_view_margin_rad(car_box(-20.0, 0.0), 80.0 * kDegree), 0.0);
  EXPECT_DOUBLE_EQ(field_of_view_margin_rad(car_box(-20.0, 0.0), 2.0 * std::numbers::pi), std::numbers::pi);
}

}  // namespace
}  // namespace mlo
