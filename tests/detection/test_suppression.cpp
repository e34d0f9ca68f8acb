#include <gtest/gtest.h>

#include "mlo/detection/suppression.hpp"

namespace mlo {
namespace {

Detection car(double x_m, double confidence) {
  return {ObjectClass::car, {{x_m, 0.0, 0.0}, {4.0, 2.0, 1.5}, 0.0}, confidence};
}

TEST(SuppressOverlapping, KeepsTheMostConfident) {
  // each overlaps its neighbours by a third
  const std::vector<Detection> kept =
      suppress_overlapping({car(0.0, 0.5), car(2.0, 0.9), car(4.0, 0.6)}, 0.2);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].confidence, 0.9);
  // with the middle one the weakest both others stay
  const auto ends = suppress_overlapping({car(0.0, 0.5), car(2.0, 0.4), car(4.0, 0.6)}, 0.2);
  ASSERT_EQ(ends.size(), 2U);
  EXPECT_EQ(ends[0].confidence, 0.6);
  EXPECT_EQ(ends[1].confidence, 0.5);
  EXPECT_EQ(suppress_overlapping({car(0.0, 0.5), car(2.0, 0.9), car(4.0, 0.6)}, 0.5).size(), 3U);
  EXPECT_TRUE(suppress_overlapping({}, 0.2).empty());
}

TEST(SuppressOverlapping, KeepsTheFirstOfEquals) {
  const auto kept = suppress_overlapping({car(0.1, 0.5), car(0.0, 0.5)}, 0.2);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].box.center_lidar_m.x(), 0.1);
}

}  // namespace
}  // namespace mlo
