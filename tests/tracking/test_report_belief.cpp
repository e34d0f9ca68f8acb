#include <limits>

#include <gtest/gtest.h>

#include "mlo/tracking/report_belief.hpp"

namespace mlo {
namespace {

constexpr BeliefWeights kWeights{.bias = -3.0,
                                 .per_existence = 0.5,
                                 .per_best_logit = 0.25,
                                 .per_logit = 0.125,
                                 .far = 4.0,
                                 .per_margin_deg = 0.5,
                                 .per_sd_m = -1.0,
                                 .per_wider_m = -10.0};

TEST(ReportBelief, IsTheWeightedSumOfItsCues) {
  const BeliefCues cues{.existence = 2.0,
                        .best_logit = 8.0,
                        .logit = 4.0,
                        .detectability = 0.75,
                        .margin_deg = 2.0,
                        .sd_m = 0.5,
                        .wider_m = 0.1};
  EXPECT_DOUBLE_EQ(report_belief(cues, kWeights), -3.0 + 1.0 + 2.0 + 0.5 + 1.0 + 1.0 - 0.5 - 1.0);
}

TEST(ReportBelief, MarginAndUncertaintyCountUpToABound) {
  const auto with_margin = [](double margin_deg) {
    return report_belief({.margin_deg = margin_deg}, kWeights);
  };
  EXPECT_DOUBLE_EQ(with_margin(180.0), with_margin(4.0));
  EXPECT_DOUBLE_EQ(with_margin(-180.0), with_margin(-4.0));
  EXPECT_LT(with_margin(-1.0), with_margin(1.0));
  EXPECT_DOUBLE_EQ(report_belief({.sd_m = 100.0}, kWeights), report_belief({.sd_m = 3.0}, kWeights));
}

TEST(ReportBelief, TheUsualWidthIsLearnt) {
  UsualCarWidth usual;
  for (int i = 0; i < 19; ++i) usual.add(1.9);
  EXPECT_EQ(usual.excess_m(2.5), 0.0) << "too few to tell";
  usual.add(1.9);
  EXPECT_NEAR(usual.excess_m(2.5), 0.6, 1e-12);
  for (const double absurd : {0.0, -1.0, 1e6, std::numeric_limits<double>::quiet_NaN()}) usual.add(absurd);
  EXPECT_NEAR(usual.excess_m(1.7), -0.2, 1e-12);
}

TEST(ReportBelief, EachClassHasItsWeights) {
  const ReportConfig config;
  EXPECT_EQ(&weights_for(ObjectClass::pedestrian, config), &config.pedestrian);
  EXPECT_EQ(&weights_for(ObjectClass::cyclist, config), &config.cyclist);
  for (const ObjectClass other :
       {ObjectClass::car, ObjectClass::van, ObjectClass::truck, ObjectClass::other}) {
    EXPECT_EQ(&weights_for(other, config), &config.vehicle) << to_string(other);
  }
}

}  // namespace
}  // namespace mlo
