#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "mlo/tracking/tracker.hpp"
#include "tracking/boxes.hpp"

namespace mlo {
namespace {

using test::car;
using test::kDegree;
using test::kDt_s;

const TrackedObject* find(const std::vector<TrackedObject>& objects, long id) {
  for (const TrackedObject& object : objects) {
    if (object.id == id) return &object;
  }
  return nullptr;
}

TEST(Tracker, NoDetectionsNoTracks) {
  Tracker tracker({});
  EXPECT_TRUE(tracker.process({}, SE3(), kDt_s).empty());
  EXPECT_TRUE(tracker.process({}, kDt_s).empty());
}

TEST(Tracker, AParkedCarIsOneTrackWhileTheLidarMoves) {
  Tracker tracker({});
  for (int i = 0; i < 30; ++i) {
    const SE3 T_map_lidar(so3_exp({0.0, 0.0, 1.0 * kDegree * i}), {1.0 * i, 0.0, 0.0});
    const PlacedBox parked{{50.0, 3.0, -1.0}, {4.0, 1.6, 1.5}, 0.2};
    const std::vector<Detection> seen{{ObjectClass::car, in_lidar(parked, T_map_lidar), 0.999}};
    const auto objects = tracker.process(seen, T_map_lidar, kDt_s);
    ASSERT_EQ(objects.size(), 1U);
    EXPECT_EQ(objects[0].id, 1);
    EXPECT_EQ(objects[0].hits, i + 1);
    EXPECT_EQ(objects[0].age, i + 1);
    if (i > 20) {
      EXPECT_LT(objects[0].moving_probability, 0.2);
    }
    EXPECT_LT((objects[0].T_map_object.translation() - parked.center_map_m).norm(), 0.05);
    EXPECT_LT((objects[0].box.center_lidar_m - seen[0].box.center_lidar_m).norm(), 0.05);
  }
}

TEST(Tracker, CrossingCarsKeepTheirIdentities) {
  Tracker tracker({});
  // They meet at (20, 0), 2.5 m apart at the nearest, one along x, one along y.
  const auto scene = [](int i) {
    const double s = 0.8 * (i - 20);
    return std::vector<Detection>{car(20.0 + s, 0.0, 0.0), car(22.0, 1.5 + s, 90.0 * kDegree)};
  };
  auto objects = tracker.process(scene(0), SE3(), kDt_s);
  ASSERT_EQ(objects.size(), 2U);
  const long along = objects[0].id;
  const long across = objects[1].id;
  for (int i = 1; i < 40; ++i) objects = tracker.process(scene(i), SE3(), kDt_s);
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_NEAR(find(objects, along)->velocity_map_mps.x(), 8.0, 0.5);
  EXPECT_NEAR(find(objects, across)->velocity_map_mps.y(), 8.0, 0.5);
}

TEST(Tracker, AnOccludedCarComesBackAsItself) {
  Tracker tracker({});
  const auto x_m = [](int i) { return 30.0 + 0.5 * i; };
  for (int i = 0; i < 20; ++i) tracker.process({{car(x_m(i), 5.0)}}, SE3(), kDt_s);
  std::vector<TrackedObject> objects;
  for (int i = 20; i < 24; ++i) {  // a car in front of it takes its place in the view
    objects = tracker.process({{car(15.0, 0.43 * 15.0 * 5.0 / x_m(i) + 1.0, 90.0 * kDegree)}}, SE3(), kDt_s);
    ASSERT_NE(find(objects, 1), nullptr) << "scan " << i;
    EXPECT_EQ(find(objects, 1)->state, TrackState::coasting);
    EXPECT_NEAR(find(objects, 1)->box.center_lidar_m.x(), x_m(i), 0.5);
    EXPECT_FALSE(find(objects, 1)->detection.has_value());
  }
  objects = tracker.process({{car(x_m(24), 5.0)}}, SE3(), kDt_s);
  ASSERT_NE(find(objects, 1), nullptr);
  EXPECT_EQ(find(objects, 1)->state, TrackState::confirmed);
  EXPECT_EQ(find(objects, 1)->detection, std::optional<std::size_t>(0));
}

TEST(Tracker, ADrivingCarOutOfSightIsShownUntilItMayBeAnywhere) {
  // Beyond where a miss tells anything: it is believed to exist, but its speed may change.
  Tracker driving({});
  Tracker parked({});
  int driving_shown = 0;
  int parked_shown = 0;
  for (int i = 0; i < 30; ++i) {
    const bool seen = i < 15;
    const std::vector<Detection> here{car(65.0 + 1.5 * i, 0.0)};
    const std::vector<Detection> there{car(65.0, 0.0)};
    const auto moving = driving.process(seen ? here : std::vector<Detection>{}, SE3(), kDt_s);
    const auto standing = parked.process(seen ? there : std::vector<Detection>{}, SE3(), kDt_s);
    if (seen) continue;
    driving_shown += moving.at(0).reported ? 1 : 0;
    parked_shown += standing.at(0).reported ? 1 : 0;
    if (!moving.at(0).reported) continue;
    EXPECT_NEAR(moving.at(0).T_map_object.translation().x(), 65.0 + 1.5 * i, 2.0);
  }
  EXPECT_GE(driving_shown, 2);
  EXPECT_LE(driving_shown, 8);
  EXPECT_GT(parked_shown, driving_shown);
}

TEST(Tracker, BirthNeedsEvidenceAndDeathFollowsMisses) {
  TrackingConfig config;
  config.lifecycle.max_coasting = 2;  // the paper's
  Tracker tracker(config);
  auto objects = tracker.process({{car(10.0, 0.0, 0.0, 0.6)}}, SE3(), kDt_s);
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].state, TrackState::tentative);
  EXPECT_FALSE(objects[0].reported);
  for (int i = 0; i < 4; ++i) objects = tracker.process({{car(10.0, 0.0, 0.0, 0.9999)}}, SE3(), kDt_s);
  EXPECT_EQ(objects[0].state, TrackState::confirmed);
  EXPECT_TRUE(objects[0].reported);
  EXPECT_EQ(tracker.process({}, SE3(), kDt_s).size(), 1U);
  EXPECT_EQ(tracker.process({}, SE3(), kDt_s).size(), 1U);
  EXPECT_TRUE(tracker.process({}, SE3(), kDt_s).empty());
  objects = tracker.process({{car(10.0, 0.0)}}, SE3(), kDt_s);
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].id, 2) << "ids are not used again";
}

TEST(Tracker, WeakDetectionsAloneAreNeverReported) {
  Tracker tracker({});
  for (int i = 0; i < 50; ++i) {
    for (const TrackedObject& object : tracker.process({{car(10.0, 0.0, 0.0, 0.55)}}, SE3(), kDt_s)) {
      EXPECT_FALSE(object.reported);
    }
  }
}

TEST(Tracker, CarsMayBeWiderThanThoseOfAnotherDetector) {
  Detection wide = car(10.0, 0.0);
  wide.box.size_lwh_m.y() = 2.1;
  Tracker tracker({});
  std::vector<TrackedObject> objects;
  for (int i = 0; i < 200; ++i) objects = tracker.process({{wide, car(20.0, 8.0)}}, SE3(), kDt_s);
  ASSERT_EQ(objects.size(), 2U);
  const double apart = objects[1].belief - objects[0].belief;
  wide.box.size_lwh_m.y() = 1.6;
  Tracker narrow({});
  for (int i = 0; i < 200; ++i) objects = narrow.process({{wide, car(20.0, 8.0)}}, SE3(), kDt_s);
  EXPECT_GT(apart, objects[1].belief - objects[0].belief) << "it is still the less likely car of the two";
  Tracker all_wide({});
  wide.box.size_lwh_m.y() = 2.1;
  for (int i = 0; i < 200; ++i) objects = all_wide.process({{wide}}, SE3(), kDt_s);
  EXPECT_TRUE(objects.at(0).reported);
}

TEST(Tracker, TwoIdenticalBoxesAreOneReportedObject) {
  Tracker tracker({});
  std::set<long> reported;
  for (int i = 0; i < 20; ++i) {
    for (const TrackedObject& object : tracker.process({{car(10.0, 0.0), car(10.0, 0.0)}}, SE3(), kDt_s)) {
      if (object.reported) reported.insert(object.id);
    }
  }
  EXPECT_EQ(reported.size(), 1U);
}

TEST(Tracker, AFalseAlarmOfAnotherKindDoesNotEndABelievedTrack) {
  Tracker tracker({});
  for (int i = 0; i < 10; ++i) tracker.process(std::vector<Detection>{car(15.0, 0.0)}, SE3(), kDt_s);
  const Detection pedestrian{
      ObjectClass::pedestrian, {.center_lidar_m = {15.5, 0.3, -1.0}, .size_lwh_m = {0.8, 0.7, 1.7}}, 0.5};
  tracker.process(std::vector<Detection>{pedestrian}, SE3(), kDt_s);  // in place of the car, once
  const auto objects = tracker.process(std::vector<Detection>{car(15.0, 0.0)}, SE3(), kDt_s);
  ASSERT_NE(find(objects, 1), nullptr);
  EXPECT_EQ(find(objects, 1)->hits, 11);
  EXPECT_EQ(objects.size(), 1U) << "the false alarm ends where the car is seen again";
}

TEST(Tracker, BoxesThatAreNoBoxesAreLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  Detection flat = car(10.0, 0.0);
  flat.box.size_lwh_m.z() = 0.0;
  Detection negative = car(10.0, 5.0);
  negative.box.size_lwh_m.x() = -4.0;
  Tracker tracker({});
  EXPECT_TRUE(
      tracker.process({{car(nan, 0.0), car(0.0, infinity), car(0.0, 0.0, nan), flat, negative}}, SE3(), kDt_s)
          .empty());
}

TEST(Tracker, AbsurdSizesDoNoHarmToOthers) {
  Tracker tracker({});
  Detection absurd = car(40.0, 0.0);
  absurd.box.size_lwh_m = {1e6, 1e6, 1e6};
  std::vector<TrackedObject> objects;
  for (int i = 0; i < 10; ++i) objects = tracker.process({{car(10.0, 0.0), absurd}}, SE3(), kDt_s);
  ASSERT_FALSE(objects.empty());
  EXPECT_EQ(objects[0].id, 1);
  EXPECT_EQ(objects[0].hits, 10);
  EXPECT_TRUE(objects[0].T_map_object.is_finite());
}

TEST(Tracker, WithoutPosesTheLidarsMotionIsFoundFromTheBoxes) {
  Tracker tracker({});
  const std::vector<PlacedBox> parked{{{15.0, 4.0, -1.0}, {4.0, 1.6, 1.5}, 0.0},
                                      {{25.0, -4.0, -1.0}, {4.2, 1.7, 1.5}, 0.0},
                                      {{40.0, 4.0, -1.0}, {3.8, 1.6, 1.4}, 0.1},
                                      {{45.0, -5.0, -1.0}, {4.0, 1.6, 1.5}, 0.0}};
  SE3 truth;
  const SE3 increment(so3_exp({0.0, 0.0, 0.3 * kDegree}), {0.8, 0.0, 0.0});
  std::vector<TrackedObject> objects;
  for (int i = 0; i < 25; ++i) {
    if (i >= 5) truth = truth * increment;  // after a standstill
    std::vector<Detection> seen;
    for (const PlacedBox& box : parked) seen.push_back({ObjectClass::car, in_lidar(box, truth), 0.9999});
    objects = tracker.process(seen, kDt_s);
  }
  ASSERT_EQ(objects.size(), 4U);
  for (const TrackedObject& object : objects) EXPECT_EQ(object.hits, 25);
  const SE3 error = truth.inverse() * tracker.T_map_lidar();
  EXPECT_LT(error.translation().norm(), 0.5);
  EXPECT_LT(error.rotation_angle_rad(), 1.0 * kDegree);
}

}  // namespace
}  // namespace mlo
