#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/evaluation/object_trajectories.hpp"

namespace mlo {
namespace {

using Objects = std::vector<ObjectPose>;

constexpr std::size_t kLifeFrames = 20;

ObjectPose at(std::size_t frame, long id, double x_m, double y_m, double yaw_rad = 0.0) {
  ObjectPose object;
  object.frame = frame;
  object.id = id;
  object.type = "car";
  object.T_map_object =
      SE3(Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), {x_m, y_m, 0.0});
  return object;
}

// Cars that drive 0.5 m a frame, 10 m beside each other: ids 0 ... count - 1.
Objects driving_cars(long count, std::size_t frames = kLifeFrames) {
  Objects objects;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    for (long id = 0; id < count; ++id) {
      objects.push_back(at(frame, id, 0.5 * static_cast<double>(frame), 10.0 * static_cast<double>(id)));
    }
  }
  return objects;
}

TEST(ObjectTrajectories, PerfectTracksHaveNoErrors) {
  Objects tracks = driving_cars(3);
  for (ObjectPose& pose : tracks) pose.id = 70 - pose.id;
  const ObjectEvaluation evaluation = evaluate_objects(driving_cars(3), tracks);
  ASSERT_EQ(evaluation.objects.size(), 3U);
  EXPECT_TRUE(evaluation.tracks_without_object.empty());
  for (const ObjectErrors& object : evaluation.objects) {
    EXPECT_EQ(object.track_id, 70 - object.truth_id);
    EXPECT_EQ(object.tracked_frames, kLifeFrames);
    EXPECT_EQ(object.other_frames + object.missed_frames + object.switches, 0U);
    EXPECT_DOUBLE_EQ(object.truth_path_m, 9.5);
    EXPECT_NEAR(object.ate_m.value(), 0.0, 1e-9);
    EXPECT_NEAR(object.rte_m_per_m.value(), 0.0, 1e-9);
    EXPECT_NEAR(object.rre_deg_per_m.value(), 0.0, 1e-6);
  }
}

TEST(ObjectTrajectories, AConstantOffsetMovesTheUnalignedErrorOnly) {
  Objects tracks = driving_cars(1);
  for (ObjectPose& pose : tracks) pose = at(pose.frame, 0, pose.T_map_object.translation().x(), 0.3);
  const ObjectErrors error = evaluate_objects(driving_cars(1), tracks).objects.front();
  EXPECT_NEAR(error.position_rmse_m.value(), 0.3, 1e-12);
  EXPECT_NEAR(error.ate_m.value(), 0.0, 1e-9);
  EXPECT_NEAR(error.rte_m_per_m.value(), 0.0, 1e-9);
}

TEST(ObjectTrajectories, KnownRelativeErrors) {
  // 2 % too far and 0.01 rad a metre too much of a turn: sub-paths of 1 m are two frames of 0.5 m.
  Objects tracks;
  for (std::size_t frame = 0; frame < kLifeFrames; ++frame) {
    const double way_m = 0.5 * static_cast<double>(frame);
    tracks.push_back(at(frame, 0, 1.02 * way_m, 0.0, 0.01 * way_m));
  }
  const ObjectErrors error = evaluate_objects(driving_cars(1), tracks).objects.front();
  EXPECT_NEAR(error.rre_deg_per_m.value(), 0.01 * 180.0 / std::numbers::pi, 1e-9);
  // The step is seen in the turned frame of the track: between 0 and 0.09 rad off, which adds up to 1.02
  // times that across.
  double expected = 0.0;
  for (int i = 0; i < 18; ++i) {
    const double yaw = 0.005 * i;
    expected += std::hypot(1.02 * std::cos(yaw) - 1.0, 1.02 * std::sin(yaw)) / 18.0;
  }
  EXPECT_NEAR(error.rte_m_per_m.value(), expected, 1e-12);
}

TEST(ObjectTrajectories, AStandingObjectHasNoErrorPerMetre) {
  Objects truth;
  for (std::size_t frame = 0; frame < 5; ++frame) truth.push_back(at(frame, 4, 1.0, 2.0));
  const ObjectErrors error = evaluate_objects(truth, truth).objects.front();
  EXPECT_EQ(error.ate_m, 0.0);
  EXPECT_FALSE(error.rte_m_per_m || error.rre_deg_per_m);
}

TEST(ObjectTrajectories, LostObjectsAndStrayTracksAreCounted) {
  Objects tracks = driving_cars(1);
  for (std::size_t frame = 0; frame < 3; ++frame) tracks.push_back(at(frame, 99, -50.0, 0.0));
  const ObjectEvaluation evaluation = evaluate_objects(driving_cars(2), tracks);
  EXPECT_FALSE(evaluation.objects[1].track_id);
  EXPECT_FALSE(evaluation.objects[1].ate_m);
  EXPECT_EQ(evaluation.objects[1].missed_frames, kLifeFrames);
  EXPECT_THAT(evaluation.tracks_without_object, testing::ElementsAre(99));
  const ObjectSummary summary = summarise(evaluation.objects);
  EXPECT_EQ(summary.lost, 1U);
  EXPECT_EQ(summary.missed_frames, kLifeFrames);
  EXPECT_NEAR(summary.ate_m.value(), 0.0, 1e-9);  // of the one that has it
}

TEST(ObjectTrajectories, ASwitchedTrackIsMeasuredByItsLongerPart) {
  // After frame 12 another track takes over.
  Objects tracks = driving_cars(1);
  for (ObjectPose& pose : tracks) {
    if (pose.frame >= 12) pose.id = 8;
  }
  const ObjectEvaluation evaluation = evaluate_objects(driving_cars(1), tracks);
  const ObjectErrors& error = evaluation.objects.front();
  EXPECT_EQ(error.track_id, 0);
  EXPECT_EQ(error.tracked_frames, 12U);
  EXPECT_EQ(error.other_frames, 8U);
  EXPECT_EQ(error.switches, 1U);
  EXPECT_EQ(error.missed_frames, 0U);
  EXPECT_THAT(evaluation.tracks_without_object, testing::ElementsAre(8));
}

TEST(ObjectTrajectories, ASwitchAfterAGapCountsToo) {
  Objects tracks;
  for (const ObjectPose& pose : driving_cars(1)) {
    if (pose.frame >= 5 && pose.frame < 8) continue;
    tracks.push_back(pose);
    if (pose.frame >= 8) tracks.back().id = 3;
  }
  const ObjectErrors error = evaluate_objects(driving_cars(1), tracks).objects.front();
  EXPECT_EQ(error.track_id, 3);
  EXPECT_EQ(error.switches, 1U);
  EXPECT_EQ(error.missed_frames, 3U);
  EXPECT_EQ(error.other_frames, 5U);
  EXPECT_EQ(error.tracked_frames, 12U);
}

TEST(ObjectTrajectories, AReusedIdBelongsToOneObjectOnly) {
  Objects truth;
  Objects tracks;
  for (std::size_t frame = 0; frame < 10; ++frame) {
    truth.push_back(at(frame, frame < 4 ? 0 : 1, static_cast<double>(frame), frame < 4 ? 0.0 : 40.0));
    tracks.push_back(truth.back());
    tracks.back().id = 5;
  }
  const ObjectEvaluation evaluation = evaluate_objects(truth, tracks);
  EXPECT_FALSE(evaluation.objects[0].track_id);
  EXPECT_EQ(evaluation.objects[0].other_frames, 4U);
  EXPECT_EQ(evaluation.objects[1].track_id, 5);
}

TEST(ObjectTrajectories, ATrackThatDriftsAwayShowsItInItsError) {
  // Beyond the gate from frame 10 on: measured over all frames, counted as missed.
  Objects tracks;
  for (std::size_t frame = 0; frame < kLifeFrames; ++frame) {
    tracks.push_back(at(frame, 0, 0.5 * static_cast<double>(frame), frame < 10 ? 0.0 : 5.0));
  }
  const ObjectErrors error = evaluate_objects(driving_cars(1), tracks).objects.front();
  EXPECT_EQ(error.tracked_frames, 10U);
  EXPECT_EQ(error.missed_frames, 10U);
  EXPECT_NEAR(error.position_rmse_m.value(), 5.0 / std::sqrt(2.0), 1e-9);
  EXPECT_GT(error.ate_m.value(), 0.5);
}

TEST(ObjectTrajectories, AnotherTrackNearbyDoesNotStealAFrame) {
  // A second track comes nearer than the first for a moment: the first still covers the object.
  Objects tracks;
  for (const ObjectPose& pose : driving_cars(1)) {
    const double x_m = pose.T_map_object.translation().x();
    tracks.push_back(at(pose.frame, 0, x_m, 0.5));
    if (pose.frame > 5 && pose.frame < 9) tracks.push_back(at(pose.frame, 1, x_m, 0.1));
  }
  const ObjectErrors error = evaluate_objects(driving_cars(1), tracks).objects.front();
  EXPECT_EQ(error.switches, 0U);
  EXPECT_EQ(error.tracked_frames, kLifeFrames);
}

TEST(ObjectTrajectories, FramesWithFewReturnsAreNotDemanded) {
  Objects truth = driving_cars(1);
  for (ObjectPose& pose : truth) pose.points = pose.frame < 15 ? 100 : 2;
  EXPECT_EQ(evaluate_objects(truth, {}).objects.front().missed_frames, 15U);
  for (ObjectPose& pose : truth) pose.points = 0;
  EXPECT_TRUE(evaluate_objects(truth, {}).objects.empty());
}

TEST(ObjectTrajectories, NothingAndNotANumber) {
  EXPECT_TRUE(evaluate_objects({}, {}).objects.empty());
  EXPECT_EQ(evaluate_objects({}, driving_cars(2)).tracks_without_object.size(), 2U);
  EXPECT_FALSE(summarise({}).ate_m);
  Objects tracks = driving_cars(1);
  tracks[3] = at(3, 0, std::numeric_limits<double>::quiet_NaN(), 0.0);
  const ObjectErrors error = evaluate_objects(driving_cars(1), tracks).objects.front();
  EXPECT_EQ(error.missed_frames, 1U);
  EXPECT_NEAR(error.ate_m.value(), 0.0, 1e-9);
  // One frame: a position, no motion.
  const ObjectErrors single = evaluate_objects(driving_cars(1, 1), driving_cars(1, 1)).objects.front();
  EXPECT_EQ(single.ate_m, 0.0);
  EXPECT_FALSE(single.rte_m_per_m);
}

}  // namespace
}  // namespace mlo
