#include <numbers>
#include <optional>
#include <random>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "mlo/tracking/tracker.hpp"
#include "tracking/boxes.hpp"
#include "tracking/car_scan.hpp"

namespace mlo {
namespace {

using test::kDegree;
using test::kDt_s;

constexpr SweepTiming kCompensated{.motion_compensated = true};

SE3 lidar_pose(int scan) {
  return {so3_exp({0.0, 0.0, 0.5 * kDegree * scan}), {0.8 * scan, 0.0, 0.0}};
}

/// A car that drives a curve at 7 m/s.
SE3 car_pose(int scan) {
  const double yaw = 1.0 * kDegree * scan;
  const double radius_m = 0.7 / (1.0 * kDegree);
  return {so3_exp({0.0, 0.0, yaw}),
          {12.0 + radius_m * std::sin(yaw), 4.0 + radius_m * (1.0 - std::cos(yaw)), -0.9}};
}

ObjectPoints sight_at(const SE3& T_map_object, int scan) {
  std::mt19937 random(static_cast<unsigned>(scan));
  std::normal_distribution<double> normal;
  const SE3 L = lidar_pose(scan).inverse() * T_map_object;
  ObjectPoints object;
  object.detection.object_class = ObjectClass::car;
  object.detection.confidence = 0.999;
  const double yaw = so3_log(L.rotation()).z();
  object.detection.box = {
      L.translation() + 0.1 * Eigen::Vector3d(normal(random), normal(random), 0.3 * normal(random)),
      {4.0, 1.6, 1.4},
      yaw + 2.0 * kDegree * normal(random)};
  object.points = test::as_scan(test::seen_from_lidar(L, 0.01, static_cast<unsigned>(scan)));
  return object;
}

ObjectPoints sight(int scan) {
  return sight_at(car_pose(scan), scan);
}

TEST(ObjectOdometry, MotionsOfEquations14And15) {
  // An object at rest in the world: H undoes the ego increment, so that X and the body-fixed motion vanish.
  const SE3 delta(so3_exp({0.0, 0.0, 0.1}), {1.0, 0.2, 0.0});
  EXPECT_LT(absolute_motion(delta, delta).log().norm(), 1e-12);
  // In general the pose moves on by the body-fixed motion: T_ol L = T_ol' L' with L' = H^-1 L.
  const SE3 H(so3_exp({0.0, 0.0, -0.05}), {-0.4, 0.1, 0.0});
  const SE3 L(so3_exp({0.0, 0.0, 0.7}), {20.0, 5.0, -1.0});
  const SE3 moved = L * body_fixed_motion(L, absolute_motion(delta, H));
  EXPECT_TRUE(moved.matrix().isApprox((delta * H.inverse() * L).matrix(), 1e-12));
}

TEST(ObjectOdometry, FollowsADrivingCarBetterThanItsBoxes) {
  Tracker tracker({});
  double squared_error = 0.0;
  double squared_box_error = 0.0;
  std::vector<TrackedObject> objects;
  for (int scan = 0; scan < 40; ++scan) {
    const std::vector<ObjectPoints> seen{sight(scan)};
    objects = tracker.process(seen, lidar_pose(scan), kDt_s, kCompensated);
    ASSERT_EQ(objects.size(), 1U);
    EXPECT_EQ(objects[0].relative_motion.usable(), scan > 0);
    const Eigen::Vector3d truth = car_pose(scan).translation();
    squared_error += (objects[0].T_map_object.translation() - truth).squaredNorm();
    squared_box_error += (lidar_pose(scan) * seen[0].detection.box.center_lidar_m - truth).squaredNorm();
  }
  EXPECT_LT(squared_error, 0.6 * squared_box_error);
  EXPECT_NEAR(objects[0].velocity_map_mps.norm(), 7.0, 0.3);
  EXPECT_NEAR(objects[0].turn_rate_radps, 10.0 * kDegree, 4.0 * kDegree);
  EXPECT_GT(objects[0].moving_probability, 0.95);
  EXPECT_GT(objects[0].num_points, 100U);
}

TEST(ObjectOdometry, FlippedBoxesDoNotTurnTheObject) {
  Tracker tracker({});
  for (int scan = 0; scan < 20; ++scan) {
    std::vector<ObjectPoints> seen{sight(scan)};
    if (scan % 5 == 4) seen[0].detection.box.yaw_rad += std::numbers::pi;
    const auto objects = tracker.process(seen, lidar_pose(scan), kDt_s, kCompensated);
    ASSERT_EQ(objects.size(), 1U);
    const double yaw = so3_log(objects[0].T_map_object.rotation()).z();
    EXPECT_NEAR(yaw, 1.0 * kDegree * scan, 6.0 * kDegree) << "scan " << scan;
  }
}

TEST(ObjectOdometry, WhatStandsIsHeld) {
  struct Errors {
    double off_m = 0.0;
    double steps_m = 0.0;  // a standing car's way, all of it false
  };
  const auto errors = [](double standing_gain) {
    TrackingConfig config;
    config.sgf.standing_gain = standing_gain;
    Tracker tracker(config);
    Errors sum;
    std::optional<Eigen::Vector3d> before;
    for (int scan = 0; scan < 40; ++scan) {
      const ObjectPoints seen = sight_at(car_pose(0), scan);
      const auto objects = tracker.process(std::vector{seen}, lidar_pose(scan), kDt_s, kCompensated);
      const Eigen::Vector3d now = objects.at(0).T_map_object.translation();
      sum.off_m += (now - car_pose(0).translation()).norm() / 40.0;
      if (before) sum.steps_m += (now - *before).norm();
      before = now;
    }
    return sum;
  };
  const Errors held = errors(0.1);
  const Errors accumulated = errors(1.0);
  EXPECT_LT(held.steps_m, 0.5 * accumulated.steps_m);
  EXPECT_LT(held.off_m, 0.05);
}

TEST(ObjectOdometry, AGapIsBridged) {
  Tracker tracker({});
  std::vector<TrackedObject> objects;
  for (int scan = 0; scan < 30; ++scan) {
    std::vector<ObjectPoints> seen{sight(scan)};
    if (scan == 15 || scan == 16) seen.clear();
    objects = tracker.process(seen, lidar_pose(scan), kDt_s, kCompensated);
  }
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].id, 1);
  EXPECT_LT((objects[0].T_map_object.translation() - car_pose(29).translation()).norm(), 0.15);
}

TEST(ObjectOdometry, BoxesWithoutPointsAreFollowed) {
  Tracker tracker({});
  std::vector<TrackedObject> objects;
  for (int scan = 0; scan < 20; ++scan) {
    std::vector<ObjectPoints> seen{sight(scan)};
    seen[0].points.resize(scan % 3 == 0 ? 0 : 1);
    objects = tracker.process(seen, lidar_pose(scan), kDt_s, kCompensated);
  }
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_LT((objects[0].T_map_object.translation() - car_pose(19).translation()).norm(), 0.4);
}

TEST(ObjectOdometry, BoxesThatAreNoBoxesLeaveTheirPointsOut) {
  std::vector<ObjectPoints> seen{sight(0)};
  seen[0].detection.box.size_lwh_m.setZero();
  EXPECT_TRUE(Tracker({}).process(seen, SE3(), kDt_s, kCompensated).empty());
}

TEST(ObjectOdometry, ABoxOfAbsurdSizeAroundAllPointsStaysFinite) {
  for (const double size_m : {1e-6, 1e6}) {
    Tracker tracker({});
    for (int scan = 0; scan < 10; ++scan) {
      std::vector<ObjectPoints> seen{sight(scan)};
      seen[0].detection.box.size_lwh_m.setConstant(size_m);
      for (const TrackedObject& object : tracker.process(seen, lidar_pose(scan), kDt_s, kCompensated)) {
        EXPECT_TRUE(object.T_map_object.is_finite()) << size_m;
        EXPECT_TRUE(object.velocity_map_mps.allFinite()) << size_m;
      }
    }
  }
}

TEST(ObjectOdometry, TwoIdenticalBoxesWithTheSamePointsAreOneReportedObject) {
  Tracker tracker({});
  std::vector<TrackedObject> objects;
  for (int scan = 0; scan < 20; ++scan) {
    const std::vector<ObjectPoints> seen{sight(scan), sight(scan)};
    objects = tracker.process(seen, lidar_pose(scan), kDt_s, kCompensated);
  }
  std::erase_if(objects, [](const TrackedObject& object) { return !object.reported; });
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_LT((objects[0].T_map_object.translation() - car_pose(19).translation()).norm(), 0.15);
}

TEST(ObjectOdometry, TheSameForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    Tracker tracker({});
    std::vector<TrackedObject> objects;
    tbb::task_arena arena(threads);
    arena.execute([&] {
      for (int scan = 0; scan < 10; ++scan) {
        std::vector<ObjectPoints> seen{sight(scan), sight(scan), sight(scan)};
        seen[1].detection.box.center_lidar_m.y() += 6.0;
        for (Point& p : seen[1].points) p.p_lidar.y() += 6.0F;
        seen[2].detection.box.center_lidar_m.y() -= 6.0;
        for (Point& p : seen[2].points) p.p_lidar.y() -= 6.0F;
        objects = tracker.process(seen, lidar_pose(scan), kDt_s, kCompensated);
      }
    });
    return objects;
  };
  const auto one = run(1);
  const auto four = run(4);
  ASSERT_EQ(one.size(), four.size());
  ASSERT_GE(one.size(), 3U);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].T_map_object.translation(), four[i].T_map_object.translation());
  }
}

}  // namespace
}  // namespace mlo
