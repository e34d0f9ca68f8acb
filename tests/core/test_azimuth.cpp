#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mlo/core/azimuth.hpp"

namespace mlo {
namespace {

TEST(AzimuthTurns, AgreesWithAtan2) {
  for (int i = 0; i < 100000; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 100000.0;
    const float radius = 0.5F + static_cast<float>(i % 97);
    const float x = radius * static_cast<float>(std::cos(angle));
    const float y = radius * static_cast<float>(std::sin(angle));
    const double exact =
        std::atan2(static_cast<double>(y), static_cast<double>(x)) / (2.0 * std::numbers::pi);
    const double difference = azimuth_turns(x, y) - exact;
    ASSERT_LT(std::abs(difference - std::round(difference)), 1e-7) << angle;
    ASSERT_GE(azimuth_turns(x, y), 0.0F);
    ASSERT_LT(azimuth_turns(x, y), 1.0F);
  }
  EXPECT_EQ(azimuth_turns(0.0F, 0.0F), 0.0F);
  EXPECT_EQ(azimuth_turns(1.0F, -1e-30F), 0.0F);
}

TEST(AzimuthRad, RunsFromBehindOverAheadToBehind) {
  EXPECT_FLOAT_EQ(azimuth_rad(1.0F, 1.0F), 0.25F * std::numbers::pi_v<float>);
  EXPECT_FLOAT_EQ(azimuth_rad(1.0F, -1.0F), -0.25F * std::numbers::pi_v<float>);
  EXPECT_FLOAT_EQ(azimuth_rad(-1.0F, -1e-6F), -std::numbers::pi_v<float>);
  EXPECT_EQ(azimuth_rad(0.0F, 0.0F), 0.0F);
}

}  // namespace
}  // namespace mlo
