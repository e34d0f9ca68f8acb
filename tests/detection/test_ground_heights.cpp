#include <gtest/gtest.h>

#include "detection/made_scan.hpp"
#include "mlo/detection/ground_heights.hpp"

namespace mlo {
namespace {

TEST(GroundHeights, OfNothing) {
  const GroundHeights none({}, {}, 50.0);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.at({3.0F, 4.0F}), 0.0F);
}

TEST(GroundHeights, FollowASlopeAndIgnoreWhatStandsOnIt) {
  test::MadeScan scan;
  for (double x = -30.0; x < 30.0; x += 0.5) {
    for (double y = -30.0; y < 30.0; y += 0.5) scan.add({x, y, -1.7 + 0.05 * x}, true);
  }
  scan.add({10.0, 10.0, 5.0});
  const GroundHeights ground(scan.points, scan.is_ground, 50.0);
  EXPECT_FALSE(ground.empty());
  for (const float x : {-29.0F, -10.0F, 0.0F, 10.0F, 29.0F}) {
    EXPECT_NEAR(ground.at({x, 10.0F}), -1.7F + 0.05F * x, 0.06F);
  }
  for (float x = -25.0F; x < 25.0F; x += 0.1F) {
    EXPECT_NEAR(ground.interpolated_at({x, 10.0F}), -1.7F + 0.05F * x, 0.015F);
  }
}

TEST(GroundHeights, GoOnWhereNothingIsSeen) {
  test::MadeScan scan;
  scan.add({5.0, 0.0, -1.5}, true);
  const GroundHeights ground(scan.points, scan.is_ground, 50.0);
  EXPECT_FLOAT_EQ(ground.at({-49.0F, 49.0F}), -1.5F);
  EXPECT_FLOAT_EQ(ground.at({500.0F, -500.0F}), -1.5F);
  EXPECT_FLOAT_EQ(ground.interpolated_at({500.0F, -500.0F}), -1.5F);
}

}  // namespace
}  // namespace mlo
