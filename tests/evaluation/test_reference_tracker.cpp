#include <cmath>

#include <gtest/gtest.h>

#include "mlo/evaluation/tracking_evaluation.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "real_data.hpp"

namespace mlo {
namespace {

double percent(double share) {
  return std::round(1e4 * share) / 100.0;
}

// A published tracker (AB3DMOT, 2020) on ten KITTI sequences; the numbers are TrackEval's and those of
// KITTI's kit.
TEST(ReferenceTracker, ScoresAsTheReferenceToolsSay) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const auto truth = read_kitti_sequences(*data / "kitti_tracking/training/label_02");
  const auto tracks = read_kitti_sequences(*data / "kitti_tracking/reference/ab3dmot_2020_pointrcnn_car");
  std::vector<SequenceRecords> sequences;
  for (const auto& [name, records] : truth) sequences.push_back({name, records, tracks.at(name)});
  ASSERT_EQ(sequences.size(), 10U);

  const TrackingScores scores = evaluate_tracking(sequences, {}).all;
  EXPECT_DOUBLE_EQ(percent(scores.hota.hota()), 68.96);
  EXPECT_DOUBLE_EQ(percent(scores.hota.det_a()), 64.75);
  EXPECT_DOUBLE_EQ(percent(scores.hota.ass_a()), 73.62);
  EXPECT_DOUBLE_EQ(percent(scores.clear.mota()), 69.88);
  EXPECT_DOUBLE_EQ(percent(scores.clear.motp()), 87.23);
  EXPECT_EQ(scores.clear.id_switches, 91U);
  EXPECT_EQ(scores.clear.fragments, 141U);
  EXPECT_EQ(scores.clear.false_positives, 2484U);
  EXPECT_EQ(scores.clear.false_negatives, 2151U);
  EXPECT_DOUBLE_EQ(percent(scores.identity.f1()), 80.22);
  EXPECT_DOUBLE_EQ(percent(scores.kit.mota()), 70.42);
  EXPECT_DOUBLE_EQ(percent(scores.kit.motp()), 86.56);
}

TEST(ReferenceTracker, TruthAgainstItselfIsPerfect) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  std::vector<SequenceRecords> sequences;
  for (const auto& [name, records] : read_kitti_sequences(*data / "kitti_tracking/training/label_02")) {
    sequences.push_back({name, records, records});
  }
  for (const char* object_class : {"car", "pedestrian", "cyclist"}) {
    const TrackingScores scores = evaluate_tracking(sequences, {.object_class = object_class}).all;
    EXPECT_GT(scores.clear.true_positives, 0U) << object_class;
    EXPECT_DOUBLE_EQ(scores.hota.hota(), 1.0) << object_class;
    EXPECT_DOUBLE_EQ(scores.clear.mota(), 1.0) << object_class;
    EXPECT_DOUBLE_EQ(scores.identity.f1(), 1.0) << object_class;
  }
}

}  // namespace
}  // namespace mlo
