#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/tracking_cases.hpp"
#include "mlo/core/error.hpp"
#include "mlo/evaluation/tracking_evaluation.hpp"

namespace mlo {
namespace {

using test::car;
using test::standing_cars;
using Records = std::vector<ObjectRecord>;

constexpr std::size_t kFrames = 10;
constexpr long kNumCars = 3;

TrackingScores scores_of(const Records& truth, const Records& tracks, const TrackingProtocol& protocol = {}) {
  return evaluate_tracking(std::vector<SequenceRecords>{{"0000", truth, tracks}}, protocol).all;
}

void expect_perfect(const TrackingScores& scores) {
  EXPECT_DOUBLE_EQ(scores.hota.hota(), 1.0);
  EXPECT_DOUBLE_EQ(scores.hota.det_a(), 1.0);
  EXPECT_DOUBLE_EQ(scores.hota.ass_a(), 1.0);
  EXPECT_DOUBLE_EQ(scores.hota.loc_a(), 1.0);
  EXPECT_DOUBLE_EQ(scores.hota.ass_re(), 1.0);
  EXPECT_DOUBLE_EQ(scores.hota.ass_pr(), 1.0);
  EXPECT_DOUBLE_EQ(scores.clear.mota(), 1.0);
  EXPECT_DOUBLE_EQ(scores.clear.motp(), 1.0);
  EXPECT_EQ(scores.clear.id_switches + scores.clear.fragments, 0U);
  EXPECT_DOUBLE_EQ(scores.identity.f1(), 1.0);
  EXPECT_DOUBLE_EQ(scores.kit.mota(), 1.0);
  EXPECT_DOUBLE_EQ(scores.kit.motp(), 1.0);
  EXPECT_EQ(scores.kit.id_switches + scores.kit.fragments, 0U);
}

TEST(TrackingEvaluation, PerfectTracksScorePerfect) {
  const Records truth = standing_cars(kFrames, kNumCars);
  for (const auto& [similarity, threshold] : {std::pair{Similarity::image_iou, 0.5},
                                              {Similarity::box_iou, 0.7},
                                              {Similarity::center_distance, 0.5}}) {
    const TrackingScores scores =
        scores_of(truth, truth, {.similarity = similarity, .match_threshold = threshold});
    expect_perfect(scores);
    EXPECT_EQ(scores.clear.mostly_tracked, 3U);
    EXPECT_EQ(scores.kit.mostly_tracked, 3U);
  }
}

TEST(TrackingEvaluation, OtherIdsAreAsGood) {
  Records tracks = standing_cars(kFrames, kNumCars);
  for (ObjectRecord& record : tracks) record.track_id = 900 - 7 * record.track_id;
  expect_perfect(scores_of(standing_cars(kFrames, kNumCars), tracks));
}

TEST(TrackingEvaluation, ShiftedBoxesMoveLocalisationOnly) {
  Records tracks = standing_cars(kFrames, kNumCars);
  for (ObjectRecord& record : tracks)
    record = car(record.frame, record.track_id, 100.0 * static_cast<double>(record.track_id) + 12.0);
  const TrackingScores scores = scores_of(standing_cars(kFrames, kNumCars), tracks);
  const double iou = 48.0 / 72.0;
  EXPECT_DOUBLE_EQ(scores.clear.motp(), iou);
  EXPECT_DOUBLE_EQ(scores.kit.motp(), iou);
  EXPECT_DOUBLE_EQ(scores.clear.mota(), 1.0);
  EXPECT_DOUBLE_EQ(scores.identity.f1(), 1.0);
  EXPECT_EQ(scores.clear.id_switches + scores.clear.fragments, 0U);
  // Thresholds 0.05 ... 0.65 are met: 13 of 19, perfectly; at the others nothing is found.
  EXPECT_NEAR(scores.hota.hota(), 13.0 / 19.0, 1e-12);
  EXPECT_NEAR(scores.hota.det_a(), 13.0 / 19.0, 1e-12);
  EXPECT_NEAR(scores.hota.loc_a(), (13.0 * iou + 6.0) / 19.0, 1e-12);
}

TEST(TrackingEvaluation, DroppedTrackMovesRecall) {
  Records tracks = standing_cars(kFrames, kNumCars);
  std::erase_if(tracks, [](const ObjectRecord& record) { return record.track_id == 1; });
  const TrackingScores scores = scores_of(standing_cars(kFrames, kNumCars), tracks);
  EXPECT_EQ(scores.clear.false_negatives, 10U);
  EXPECT_EQ(scores.clear.false_positives, 0U);
  EXPECT_EQ(scores.clear.mostly_lost, 1U);
  EXPECT_EQ(scores.kit.mostly_lost, 1U);
  EXPECT_EQ(scores.clear.id_switches + scores.clear.fragments, 0U);
  EXPECT_DOUBLE_EQ(scores.clear.mota(), 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(scores.clear.precision(), 1.0);
  EXPECT_NEAR(scores.hota.det_re(), 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(scores.hota.det_pr(), 1.0, 1e-12);
  EXPECT_NEAR(scores.hota.ass_a(), 1.0, 1e-12);
  EXPECT_DOUBLE_EQ(scores.identity.f1(), 20.0 / 25.0);
}

TEST(TrackingEvaluation, DuplicatedTrackMovesPrecision) {
  const Records truth = standing_cars(kFrames, kNumCars);
  Records tracks = truth;
  for (const ObjectRecord& record : truth) {
    if (record.track_id == 1) tracks.push_back(car(record.frame, 50, 103.0));
  }
  const TrackingScores scores = scores_of(truth, tracks);
  EXPECT_EQ(scores.clear.false_positives, 10U);
  EXPECT_EQ(scores.clear.false_negatives, 0U);
  EXPECT_DOUBLE_EQ(scores.clear.mota(), 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(scores.clear.motp(), 1.0);
  EXPECT_EQ(scores.clear.id_switches, 0U);
  EXPECT_NEAR(scores.hota.det_pr(), 0.75, 1e-12);
  EXPECT_NEAR(scores.hota.det_re(), 1.0, 1e-12);
  EXPECT_NEAR(scores.hota.ass_a(), 1.0, 1e-12);
}

TEST(TrackingEvaluation, SwappedIdsMoveAssociationOnly) {
  Records tracks = standing_cars(kFrames, kNumCars);
  for (ObjectRecord& record : tracks) {
    if (record.frame >= 6 && record.track_id < 2) record.track_id = 1 - record.track_id;
  }
  const TrackingScores scores = scores_of(standing_cars(kFrames, kNumCars), tracks);
  EXPECT_EQ(scores.clear.id_switches, 2U);
  EXPECT_EQ(scores.kit.id_switches, 2U);
  EXPECT_EQ(scores.clear.false_positives + scores.clear.false_negatives, 0U);
  EXPECT_EQ(scores.clear.fragments, 0U);
  EXPECT_DOUBLE_EQ(scores.clear.mota(), 28.0 / 30.0);
  EXPECT_DOUBLE_EQ(scores.clear.motp(), 1.0);
  EXPECT_NEAR(scores.hota.det_a(), 1.0, 1e-12);
  EXPECT_NEAR(scores.hota.loc_a(), 1.0, 1e-12);
  // Of two cars 6 boxes share 6 of 14 (10 + 10 - 6) frames, 4 boxes 4 of 16; those of the third all.
  const double ass_a = (2.0 * (6.0 * 6.0 / 14.0 + 4.0 * 4.0 / 16.0) + 10.0) / 30.0;
  EXPECT_NEAR(scores.hota.ass_a(), ass_a, 1e-12);
  EXPECT_NEAR(scores.hota.hota(), std::sqrt(ass_a), 1e-12);
  EXPECT_DOUBLE_EQ(scores.identity.f1(), 22.0 / 30.0);
}

TEST(TrackingEvaluation, GapsAreFragments) {
  Records tracks = standing_cars(kFrames, kNumCars);
  std::erase_if(tracks, [](const ObjectRecord& record) {
    return record.track_id == 0 && (record.frame == 4 || record.frame == 5);
  });
  const TrackingScores scores = scores_of(standing_cars(kFrames, kNumCars), tracks);
  EXPECT_EQ(scores.clear.fragments, 1U);
  EXPECT_EQ(scores.clear.id_switches, 0U);
  EXPECT_EQ(scores.clear.false_negatives, 2U);
  EXPECT_EQ(scores.clear.mostly_tracked, 2U);  // 8 of 10 frames is not more than 80 %
  EXPECT_EQ(scores.clear.partly_tracked, 1U);
}

TEST(TrackingEvaluation, AnotherIdAfterAGapIsASwitchForTrackEvalOnly) {
  Records tracks = standing_cars(kFrames, 1);
  std::erase_if(tracks, [](const ObjectRecord& record) { return record.frame == 5; });
  for (ObjectRecord& record : tracks) {
    if (record.frame > 5) record.track_id = 77;
  }
  const TrackingScores scores = scores_of(standing_cars(kFrames, 1), tracks);
  EXPECT_EQ(scores.clear.id_switches, 1U);
  EXPECT_EQ(scores.kit.id_switches, 0U);
  EXPECT_EQ(scores.kit.fragments, 1U);
}

TEST(TrackingEvaluation, IdsReusedByAnotherObjectAreOneTrack) {
  // One track id first on car 0, then, after a pause, on car 1.
  Records truth;
  Records tracks;
  for (std::size_t frame = 0; frame < 4; ++frame) truth.push_back(car(frame, 0, 0.0));
  for (std::size_t frame = 6; frame < 10; ++frame) truth.push_back(car(frame, 1, 500.0));
  for (ObjectRecord record : truth) {
    record.track_id = 5;
    tracks.push_back(record);
  }
  const TrackingScores scores = scores_of(truth, tracks);
  EXPECT_EQ(scores.clear.id_switches, 0U);  // CLEAR looks from the true objects only
  EXPECT_DOUBLE_EQ(scores.clear.mota(), 1.0);
  EXPECT_EQ(scores.identity.true_positives, 4U);
  EXPECT_NEAR(scores.hota.ass_pr(), 0.5, 1e-12);
  EXPECT_NEAR(scores.hota.ass_re(), 1.0, 1e-12);
}

TEST(TrackingEvaluation, NoTruthNoTracksNothing) {
  const Records cars = standing_cars(kFrames, kNumCars);
  const TrackingScores no_tracks = scores_of(cars, {});
  EXPECT_EQ(no_tracks.clear.false_negatives, 30U);
  EXPECT_EQ(no_tracks.clear.mostly_lost, 3U);
  EXPECT_EQ(no_tracks.clear.mota(), 0.0);
  EXPECT_EQ(no_tracks.hota.hota(), 0.0);
  EXPECT_EQ(no_tracks.identity.false_negatives, 30U);
  const TrackingScores no_truth = scores_of({}, cars);
  EXPECT_EQ(no_truth.clear.false_positives, 30U);
  EXPECT_EQ(no_truth.clear.mota(), -30.0);  // as TrackEval: errors per max(1, truth)
  EXPECT_EQ(no_truth.hota.hota(), 0.0);
  EXPECT_EQ(no_truth.identity.false_positives, 30U);
  EXPECT_EQ(no_truth.kit.mota(), 0.0);
  const TrackingScores nothing = scores_of({}, {});
  EXPECT_EQ(nothing.clear.mota(), 0.0);
  EXPECT_EQ(nothing.identity.f1(), 0.0);
  EXPECT_DOUBLE_EQ(nothing.hota.loc_a(), 1.0);
  const TrackingEvaluation no_sequences = evaluate_tracking({}, {});
  EXPECT_EQ(no_sequences.all.clear.true_positives, 0U);
  EXPECT_EQ(no_sequences.averaged.samota, 0.0);
}

TEST(TrackingEvaluation, OneFrameTracks) {
  // Every box a track of its own: detection is perfect, association as poor as it can be.
  Records tracks = standing_cars(kFrames, 1);
  for (std::size_t i = 0; i < tracks.size(); ++i) tracks[i].track_id = static_cast<long>(i);
  const TrackingScores scores = scores_of(standing_cars(kFrames, 1), tracks);
  EXPECT_EQ(scores.clear.id_switches, 9U);
  EXPECT_NEAR(scores.hota.det_a(), 1.0, 1e-12);
  EXPECT_NEAR(scores.hota.ass_a(), 0.1, 1e-12);
  EXPECT_EQ(scores.identity.true_positives, 1U);
}

TEST(TrackingEvaluation, AnIdTwiceInAFrameIsAnError) {
  Records twice = standing_cars(kFrames, kNumCars);
  twice.push_back(car(4, 1, 300.0));
  const auto problem = [](const Records& truth, const Records& tracks) -> std::string {
    try {
      scores_of(truth, tracks);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  const Records once = standing_cars(kFrames, kNumCars);
  EXPECT_THAT(problem(once, twice), testing::StartsWith("sequence 0000, frame 4: track 1 occurs twice"));
  EXPECT_THAT(problem(twice, once), testing::HasSubstr("frame 4: true object 1 occurs twice"));
}

TEST(TrackingEvaluation, EmptyFramesChangeNothing) {
  // Every second frame holds neither truth nor tracks; then also frames with one of the two only.
  const auto spread = [](Records records) {
    for (ObjectRecord& record : records) record.frame *= 2;
    return records;
  };
  const Records truth = spread(standing_cars(kFrames, kNumCars));
  expect_perfect(scores_of(truth, truth));
  Records late = truth;
  std::erase_if(late, [](const ObjectRecord& record) { return record.frame < 4; });
  const TrackingScores missed = scores_of(truth, late);
  EXPECT_EQ(missed.clear.false_negatives, 6U);
  EXPECT_EQ(missed.clear.false_positives + missed.clear.id_switches + missed.clear.fragments, 0U);
  const TrackingScores early = scores_of(late, truth);
  EXPECT_EQ(early.clear.false_positives, 6U);
  EXPECT_EQ(early.clear.false_negatives, 0U);
  EXPECT_DOUBLE_EQ(early.clear.motp(), 1.0);
}

TEST(TrackingEvaluation, ATrackOfOneFrameIsOneTruePositive) {
  const Records truth = standing_cars(kFrames, 1);
  const TrackingScores scores = scores_of(truth, {car(3, 7, 0.0)});
  EXPECT_EQ(scores.clear.true_positives, 1U);
  EXPECT_EQ(scores.clear.false_negatives, kFrames - 1);
  EXPECT_EQ(scores.clear.mostly_lost, 1U);
  EXPECT_NEAR(scores.hota.ass_a(), 0.1, 1e-12);
  EXPECT_NEAR(scores.hota.det_a(), 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(scores.identity.f1(), 2.0 / 11.0);
  // Truth of one frame, too: nothing is divided by the length of a life.
  expect_perfect(scores_of({car(3, 7, 0.0)}, {car(3, 1, 0.0)}));
}

TEST(TrackingEvaluation, SequencesAddUpAndKeepTheirIdsApart) {
  const Records truth = standing_cars(kFrames, kNumCars);
  Records swapped = truth;
  for (ObjectRecord& record : swapped) record.track_id = (record.track_id + 1) % kNumCars;
  const TrackingEvaluation evaluation =
      evaluate_tracking(std::vector<SequenceRecords>{{"a", truth, truth}, {"b", truth, swapped}}, {});
  expect_perfect(evaluation.all);
  EXPECT_EQ(evaluation.all.clear.true_positives, 60U);
  EXPECT_THAT(evaluation.names, testing::ElementsAre("a", "b"));
}

}  // namespace
}  // namespace mlo
