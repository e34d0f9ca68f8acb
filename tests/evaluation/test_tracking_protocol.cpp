#include <gtest/gtest.h>

#include "evaluation/tracking_cases.hpp"
#include "mlo/evaluation/tracking_evaluation.hpp"

namespace mlo {
namespace {

using test::car;
using test::standing_cars;
using Records = std::vector<ObjectRecord>;

TrackingScores score(const Records& truth, const Records& tracks, const std::string& object_class = "car") {
  return evaluate_tracking(std::vector<SequenceRecords>{{"0000", truth, tracks}},
                           {.object_class = object_class})
      .all;
}

ObjectRecord of_type(ObjectRecord record, const std::string& type) {
  record.type = type;
  return record;
}

ObjectRecord dont_care(std::size_t frame, const Box2d& region) {
  ObjectRecord record;
  record.frame = frame;
  record.type = "dontcare";
  record.image_box = region;
  return record;
}

TEST(TrackingProtocol, IgnoredTruthIsNeitherDemandedNorHeldAgainst) {
  const Records cars = standing_cars(5, 2);
  const auto ignored = [&](const auto& damage) {
    Records truth = cars;
    for (ObjectRecord& record : truth) {
      if (record.track_id == 1) damage(record);
    }
    return truth;
  };
  const Records found_one = standing_cars(5, 1);
  for (const Records& truth : {ignored([](ObjectRecord& record) { record.type = "van"; }),
                               ignored([](ObjectRecord& record) { record.truncation = 1; }),
                               ignored([](ObjectRecord& record) { record.occlusion = 3; })}) {
    for (const Records& tracks : {cars, found_one}) {
      const TrackingScores scores = score(truth, tracks);
      EXPECT_EQ(scores.clear.true_positives, 5U);
      EXPECT_EQ(scores.clear.false_positives + scores.clear.false_negatives, 0U);
      EXPECT_EQ(scores.kit.false_positives + scores.kit.false_negatives, 0U);
      EXPECT_EQ(scores.kit.truth, 5U);
      EXPECT_DOUBLE_EQ(scores.hota.hota(), 1.0);
    }
    EXPECT_EQ(score(truth, cars).kit.true_positives, 10U);  // the kit counts them here
  }
  // What is merely partly occluded is demanded.
  const Records occluded = ignored([](ObjectRecord& record) { record.occlusion = 2; });
  EXPECT_EQ(score(occluded, found_one).clear.false_negatives, 5U);
}

TEST(TrackingProtocol, OtherClassesDoNotCount) {
  Records truth = standing_cars(5, 2);
  truth.push_back(of_type(car(0, 9, 700.0), "pedestrian"));
  truth.push_back(of_type(car(0, 10, 800.0), "truck"));
  Records tracks = standing_cars(5, 2);
  tracks.push_back(of_type(car(1, 11, 900.0), "cyclist"));
  EXPECT_DOUBLE_EQ(score(truth, tracks).clear.mota(), 1.0);
  const TrackingScores pedestrians = score(truth, tracks, "pedestrian");
  EXPECT_EQ(pedestrians.clear.false_negatives, 1U);
  EXPECT_EQ(score(truth, tracks, "cyclist").clear.false_positives, 1U);
}

TEST(TrackingProtocol, SittingPersonsAreNeighboursOfPedestrians) {
  const Records truth{of_type(car(0, 1, 0.0), "person")};
  const Records tracks{of_type(car(0, 1, 0.0), "pedestrian")};
  const TrackingScores scores = score(truth, tracks, "pedestrian");
  EXPECT_EQ(scores.clear.false_positives + scores.clear.false_negatives, 0U);
}

TEST(TrackingProtocol, TracksOfANeighbouringClassAreNotMatchedByTrackEval) {
  const Records truth = standing_cars(3, 1);
  Records tracks = truth;
  for (ObjectRecord& record : tracks) record.type = "van";
  const TrackingScores scores = score(truth, tracks);
  EXPECT_EQ(scores.clear.false_negatives, 3U);
  EXPECT_EQ(scores.clear.false_positives, 0U);
  EXPECT_EQ(scores.kit.true_positives, 3U);
}

TEST(TrackingProtocol, DontCareRegionsExcuseUnmatchedTracksMostlyWithin) {
  Records truth = standing_cars(1, 1);
  Records tracks = truth;
  tracks.push_back(car(0, 5, 500.0));
  EXPECT_EQ(score(truth, tracks).clear.false_positives, 1U);

  Records half = truth;
  half.push_back(dont_care(0, {500.0, 0.0, 530.0, 300.0}));  // covers exactly half
  EXPECT_EQ(score(half, tracks).clear.false_positives, 1U);
  Records more = truth;
  more.push_back(dont_care(0, {500.0, 0.0, 531.0, 300.0}));
  EXPECT_EQ(score(more, tracks).clear.false_positives, 0U);
  EXPECT_EQ(score(more, tracks).kit.false_positives, 0U);
  Records other_frame = truth;
  other_frame.push_back(dont_care(1, {500.0, 0.0, 600.0, 300.0}));
  EXPECT_EQ(score(other_frame, tracks).clear.false_positives, 1U);

  // A match counts, whatever region it lies in.
  Records over_match = truth;
  over_match.push_back(dont_care(0, {0.0, 0.0, 1000.0, 1000.0}));
  EXPECT_EQ(score(over_match, tracks).clear.true_positives, 1U);
  EXPECT_EQ(score(over_match, tracks).clear.false_positives, 0U);
}

TEST(TrackingProtocol, SmallUnmatchedTracksAreExcused) {
  const Records truth = standing_cars(1, 1);
  for (const auto& [height_px, false_positives] : {std::pair{25.0, 0U}, {25.5, 1U}}) {
    Records tracks = truth;
    tracks.push_back(car(0, 5, 500.0));
    tracks.back().image_box.bottom_px = tracks.back().image_box.top_px + height_px;
    EXPECT_EQ(score(truth, tracks).clear.false_positives, false_positives);
    EXPECT_EQ(score(truth, tracks).kit.false_positives, false_positives);
  }
}

TEST(TrackingProtocol, ThresholdsDecideMatches) {
  const Records truth{car(0, 1, 0.0)};
  const auto matches = [&](const ObjectRecord& track, const TrackingProtocol& protocol) {
    return evaluate_tracking(std::vector<SequenceRecords>{{"0000", truth, {track}}}, protocol)
        .all.clear.true_positives;
  };
  EXPECT_EQ(matches(car(0, 1, 20.0), {}), 1U);  // IoU 40 / 80
  EXPECT_EQ(matches(car(0, 1, 20.1), {}), 0U);
  EXPECT_EQ(matches(car(0, 1, 20.0), {.similarity = Similarity::box_iou, .match_threshold = 0.5}),
            1U);  // 4 / 8
  EXPECT_EQ(matches(car(0, 1, 20.0), {.similarity = Similarity::box_iou, .match_threshold = 0.7}), 0U);
  EXPECT_EQ(matches(car(0, 1, 20.0), {.similarity = Similarity::center_distance, .max_distance_m = 2.01}),
            1U);
  EXPECT_EQ(matches(car(0, 1, 20.0), {.similarity = Similarity::center_distance, .max_distance_m = 1.99}),
            0U);
}

TEST(TrackingProtocol, AveragesOverRecallLeaveOutUnsureTracksFirst) {
  // 40 frames of one car, found with score 5, and of a false track with score 1.
  const Records truth = standing_cars(40, 1);
  Records tracks;
  for (const ObjectRecord& record : truth) {
    tracks.push_back(car(record.frame, 1, 0.0, 5.0));
    tracks.push_back(car(record.frame, 2, 500.0, 1.0));
  }
  const TrackingEvaluation evaluation =
      evaluate_tracking(std::vector<SequenceRecords>{{"0000", truth, tracks}}, {});
  EXPECT_DOUBLE_EQ(evaluation.all.kit.mota(), 0.0);
  EXPECT_DOUBLE_EQ(evaluation.averaged.best_mota, 1.0);
  EXPECT_DOUBLE_EQ(evaluation.averaged.best_score.value(), 5.0);
  // One true score only: all recall values above 0 that are reached keep the sure track alone and miss
  // nothing.
  EXPECT_NEAR(evaluation.averaged.amota, evaluation.averaged.samota, 1e-12);
  EXPECT_GT(evaluation.averaged.samota, 0.9);
}

}  // namespace
}  // namespace mlo
