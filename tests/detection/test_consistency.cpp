#include <gtest/gtest.h>

#include "mlo/core/log_odds.hpp"
#include "mlo/detection/consistency.hpp"

namespace mlo {
namespace {

Detection at(double x_m, double probability, ObjectClass object_class = ObjectClass::car) {
  return {object_class, {{x_m, 0.0, 0.0}, {4.0, 2.0, 1.5}, 0.0}, probability};
}

double weighed(const Detection& now, const std::vector<Detection>& before, const SE3& T_now_before = {}) {
  return log_odds(weigh_by_previous({now}, before, T_now_before, {}).front().confidence);
}

TEST(LogOdds, AreTheInverseOfProbability) {
  for (const double p : {0.01, 0.5, 0.9}) EXPECT_NEAR(probability(log_odds(p)), p, 1e-12);
  EXPECT_EQ(log_odds(0.5), 0.0);
  EXPECT_TRUE(std::isfinite(log_odds(0.0)) && std::isfinite(log_odds(1.0)));
}

TEST(WeighByPrevious, AddsAShareOfWhatWasThere) {
  const double alone = log_odds(0.7);
  EXPECT_NEAR(weighed(at(10.0, 0.7), {at(10.5, 0.8)}), alone + 0.5 * log_odds(0.8), 1e-9);
  EXPECT_NEAR(weighed(at(10.0, 0.7), {at(10.5, 0.2)}), alone + 0.5 * log_odds(0.2), 1e-9);
  // the nearest counts, and not for ever
  EXPECT_NEAR(weighed(at(10.0, 0.7), {at(11.0, 0.8), at(10.2, 0.6)}), alone + 0.5 * log_odds(0.6), 1e-9);
  EXPECT_NEAR(weighed(at(10.0, 0.7), {at(10.0, 1.0)}), alone + 0.5 * 4.0, 1e-9);
}

TEST(WeighByPrevious, DoubtsWhatIsNew) {
  const double new_one = log_odds(0.7) - 1.0;
  EXPECT_NEAR(weighed(at(10.0, 0.7), {}), new_one, 1e-9);
  EXPECT_NEAR(weighed(at(10.0, 0.7), {at(13.0, 0.9)}), new_one, 1e-9);
  EXPECT_NEAR(weighed(at(10.0, 0.7), {at(10.0, 0.9, ObjectClass::van)}), new_one, 1e-9);
  EXPECT_TRUE(weigh_by_previous({}, {}, {}, {}).empty());
}

TEST(WeighByPrevious, FollowsTheMotionOfTheLidar) {
  // five metres ahead since then: what was 15 m away is 10 m away
  const SE3 T_now_before(Eigen::Quaterniond::Identity(), {-5.0, 0.0, 0.0});
  EXPECT_GT(weighed(at(10.0, 0.7), {at(15.0, 0.9)}, T_now_before), log_odds(0.7));
}

}  // namespace
}  // namespace mlo
