#include <gtest/gtest.h>

#include "mlo/tracking/lifecycle.hpp"

namespace mlo {
namespace {

constexpr LifecycleConfig config() {
  LifecycleConfig config;
  config.drop_existence = -1.0;
  config.max_coasting = 3;
  config.max_tentative_misses = 1;
  return config;
}

using enum TrackState;

struct Transition {
  TrackState from;
  TrackEvidence evidence;
  TrackState to;
};

// The whole state machine: every state, with and without detection, on both sides of every threshold.
constexpr Transition kTransitions[] = {
    {tentative, {.existence = 5.0, .believed = false, .misses = 0}, tentative},
    {tentative, {.existence = 0.0, .believed = true, .misses = 0}, confirmed},
    {tentative, {.existence = 5.0, .believed = true, .misses = 1}, tentative},
    {tentative, {.existence = 5.0, .believed = true, .misses = 2}, dead},
    {tentative, {.existence = -1.1, .believed = true, .misses = 0}, dead},
    {confirmed, {.existence = 2.0, .believed = true, .misses = 0}, confirmed},
    {confirmed, {.existence = 0.0, .believed = false, .misses = 0}, confirmed},
    {confirmed, {.existence = 2.0, .believed = true, .misses = 1}, coasting},
    {confirmed, {.existence = -1.1, .believed = true, .misses = 1}, dead},
    {coasting, {.existence = 0.0, .believed = false, .misses = 0}, confirmed},
    {coasting, {.existence = 0.0, .believed = false, .misses = 3}, coasting},
    {coasting, {.existence = 5.0, .believed = true, .misses = 4}, dead},
    {coasting, {.existence = -1.1, .believed = true, .misses = 2}, dead},
    {dead, {.existence = 9.0, .believed = true, .misses = 0}, dead},
};

TEST(Lifecycle, FollowsItsTable) {
  for (const Transition& t : kTransitions) {
    EXPECT_EQ(next_state(t.from, t.evidence, config()), t.to)
        << to_string(t.from) << ", existence " << t.evidence.existence << ", believed " << t.evidence.believed
        << ", misses " << t.evidence.misses;
  }
}

TEST(Lifecycle, ThePapersTwoScansOfPredictionAreASetting) {
  LifecycleConfig paper = config();
  paper.max_coasting = 2;
  TrackState state = confirmed;
  for (int misses = 1; misses <= 2; ++misses)
    state = next_state(state, {.existence = 4.0, .misses = misses}, paper);
  EXPECT_EQ(state, coasting);
  EXPECT_EQ(next_state(state, {.existence = 4.0, .misses = 3}, paper), dead);
}

TEST(Lifecycle, DetectionsSpeakForAndAgainst) {
  const LifecycleConfig c;
  EXPECT_DOUBLE_EQ(detection_evidence(c.evidence_zero_logit, 10.0, c), 0.0);
  EXPECT_GT(detection_evidence(c.evidence_zero_logit + 1.0, 10.0, c), 0.0);
  EXPECT_LT(detection_evidence(c.evidence_zero_logit - 1.0, 10.0, c), 0.0);
  EXPECT_DOUBLE_EQ(detection_evidence(100.0, 10.0, c), c.max_evidence);
  EXPECT_DOUBLE_EQ(detection_evidence(-100.0, 10.0, c), -c.max_evidence);
  EXPECT_GT(detection_evidence(1.0, 100.0, c), detection_evidence(1.0, 10.0, c)) << "far objects score less";
}

TEST(Lifecycle, AMissInPlainViewTakesMost) {
  const LifecycleConfig c;
  EXPECT_DOUBLE_EQ(miss_evidence(1.0, c), -c.miss_visible);
  EXPECT_DOUBLE_EQ(miss_evidence(0.0, c), -c.miss_hidden);
  EXPECT_LT(miss_evidence(0.6, c), miss_evidence(0.4, c));
}

TEST(Lifecycle, DetectabilityFallsWithRange) {
  LifecycleConfig c;
  c.near_range_m = 40.0;
  c.blind_range_m = 80.0;
  EXPECT_EQ(detectability(10.0, c), 1.0);
  EXPECT_DOUBLE_EQ(detectability(60.0, c), 0.5);
  EXPECT_EQ(detectability(90.0, c), 0.0);
  c.blind_range_m = c.near_range_m;  // a step, not a division by zero
  EXPECT_EQ(detectability(40.0, c), 1.0);
  EXPECT_EQ(detectability(40.1, c), 0.0);
}

}  // namespace
}  // namespace mlo
