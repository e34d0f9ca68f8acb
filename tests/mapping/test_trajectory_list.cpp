#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "mlo/mapping/displacement.hpp"
#include "mlo/mapping/motion_belief.hpp"
#include "mlo/mapping/trajectory_list.hpp"

namespace mlo {
namespace {

const Eigen::Vector3d kSize(4.2, 1.8, 1.5);

/// Points on the rear and the left side of a car that stands at a pose, as a lidar behind it sees them.
std::vector<Eigen::Vector3f> car_points(const SE3& T_map_object, std::uint64_t seed, double noise_m = 0.02) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  std::normal_distribution<double> noise(0.0, noise_m);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 200; ++i) {
    const double z = share(random) * kSize.z();
    const Eigen::Vector3d p_object =
        i % 2 == 0 ? Eigen::Vector3d(-0.5 * kSize.x() + noise(random), share(random) * kSize.y(), z)
                   : Eigen::Vector3d(share(random) * kSize.x(), 0.5 * kSize.y() + noise(random), z);
    points.emplace_back((T_map_object * p_object).cast<float>());
  }
  return points;
}

SE3 car_at(double x_m) {
  return {so3_exp({0.0, 0.0, 0.3}), Eigen::Vector3d(x_m * std::cos(0.3) + 10.0, x_m * std::sin(0.3), 0.0)};
}

ObjectSight sight_at(double x_m, double moving_probability, std::uint64_t seed) {
  return {.id = 7,
          .T_map_object = car_at(x_m),
          .moving_probability = moving_probability,
          .points_map = car_points(car_at(x_m), seed)};
}

Mobility update(TrajectoryList& list, const ObjectSight& sight) {
  return list.update(std::span(&sight, 1)).front();
}

TrajectoryList make_list() {
  return {DynamicCheckConfig{}, RefinementConfig{}};
}

TEST(TrajectoryList, FirstSightIsAtRestUnlessItIsFast) {
  TrajectoryList list = make_list();
  EXPECT_EQ(update(list, sight_at(0.0, 0.5, 1)), Mobility::at_rest);
  TrajectoryList other = make_list();
  EXPECT_EQ(update(other, sight_at(0.0, 0.95, 1)), Mobility::moving);
}

TEST(TrajectoryList, NoisyBoxesDoNotMoveACarWhosePointsStay) {
  TrajectoryList list = make_list();
  for (std::uint64_t scan = 0; scan < 40; ++scan) {
    ObjectSight sight = sight_at(0.0, scan > 10 && scan % 3 == 0 ? 0.8 : 0.2, scan);
    sight.T_map_object = car_at(scan % 2 == 0 ? 0.3 : -0.3);
    EXPECT_EQ(update(list, sight), Mobility::at_rest) << "scan " << scan;
  }
}

TEST(TrajectoryList, FindsWhatMovesTooSlowlyForItsSpeedToTell) {
  constexpr double kStep_m = 0.02;  // 0.2 m/s
  TrajectoryList list = make_list();
  for (std::uint64_t scan = 0; scan < 10; ++scan) update(list, sight_at(0.0, 0.1, scan));
  int scans_to_motion = 0;
  double x_m = 0.0;
  for (std::uint64_t scan = 10; scan < 40; ++scan) {
    x_m += kStep_m;
    if (update(list, sight_at(x_m, 0.1, scan)) == Mobility::moving) break;
    ++scans_to_motion;
  }
  EXPECT_GE(scans_to_motion, 2) << "a few centimetres are noise";
  EXPECT_LE(scans_to_motion, 12) << "a quarter of a metre is motion";
}

TEST(TrajectoryList, WhatStopsIsAtRestAgainAfterAWhile) {
  TrajectoryList list = make_list();
  double x_m = 0.0;
  for (std::uint64_t scan = 0; scan < 10; ++scan)
    EXPECT_EQ(update(list, sight_at(x_m += 0.5, 0.9, scan)), Mobility::moving);
  std::vector<Mobility> after;
  for (std::uint64_t scan = 10; scan < 20; ++scan) after.push_back(update(list, sight_at(x_m, 0.1, scan)));
  EXPECT_EQ(after.back(), Mobility::at_rest);
  EXPECT_TRUE(std::is_sorted(after.begin(), after.end(), std::greater<>())) << "it stops once";
}

TEST(TrajectoryList, RollingToAStopItMovesAsLongAsItsPointsDo) {
  TrajectoryList list = make_list();
  double x_m = 0.0;
  std::uint64_t scan = 0;
  for (; scan < 10; ++scan) update(list, sight_at(x_m += 0.3, 0.9, scan));
  for (; scan < 20; ++scan)
    EXPECT_EQ(update(list, sight_at(x_m += 0.05, 0.3, scan)), Mobility::moving)
        << "at 0.5 m/s, scan " << scan;
  int scans_to_rest = 0;
  for (; scan < 40 && update(list, sight_at(x_m, 0.3, scan)) == Mobility::moving; ++scan) ++scans_to_rest;
  EXPECT_LE(scans_to_rest, 4);
}

TEST(TrajectoryList, WhatOnlySeemedToMoveRestsOnceItsPointsStay) {
  TrajectoryList list = make_list();
  EXPECT_EQ(update(list, sight_at(0.0, 0.99, 0)), Mobility::moving)
      << "at first sight only the speed is known";
  for (std::uint64_t scan = 1; scan < 4; ++scan) update(list, sight_at(0.0, 0.99, scan));
  EXPECT_EQ(update(list, sight_at(0.0, 0.99, 4)), Mobility::at_rest);
}

TEST(TrajectoryList, AFlatSideThatSlidesAlongItsOwnTrailMoves) {
  TrajectoryList list = make_list();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> share(-0.5F, 0.5F);
  for (int scan = 0; scan < 30; ++scan) {
    const double x_m = 0.6 * scan;
    ObjectSight sight{.id = 7,
                      .T_map_object = {so3_exp({0.0, 0.0, 0.0}), Eigen::Vector3d(x_m, 5.0, 0.0)},
                      .moving_probability = 0.99};
    // The part that is seen of a lorry's side is always the same.
    for (int i = 0; i < 600; ++i)
      sight.points_map.emplace_back(12.0F * share(random), 5.0F, 2.0F * share(random));
    for (int i = 0; i < 100; ++i)
      sight.points_map.emplace_back(6.0F, 5.0F + share(random), 2.0F * share(random));
    EXPECT_EQ(update(list, sight), Mobility::moving) << "scan " << scan;
  }
}

TEST(TrajectoryList, NewSidesOfWhatRestsAreNoMotion) {
  TrajectoryList list = make_list();
  // A car behind others comes into view, from its rear on.
  for (std::uint64_t scan = 0; scan < 40; ++scan) {
    ObjectSight sight = sight_at(0.0, 0.15, scan);
    const double seen_to_m = -0.5 * kSize.x() + 0.1 * static_cast<double>(scan);
    const SE3 T_object_map = car_at(0.0).inverse();
    std::erase_if(sight.points_map, [&](const Eigen::Vector3f& p) {
      return (T_object_map * p.cast<double>()).x() > seen_to_m;
    });
    EXPECT_EQ(update(list, sight), Mobility::at_rest) << "scan " << scan;
  }
}

TEST(TrajectoryList, AYoungMapTellsOfAClearMotion) {
  TrajectoryList list = make_list();
  double x_m = 0.0;
  for (std::uint64_t scan = 0; scan < 3; ++scan) update(list, sight_at(x_m += 0.12, 0.1, scan));
  EXPECT_EQ(update(list, sight_at(x_m += 0.12, 0.1, 3)), Mobility::moving) << "at 1.2 m/s";
}

TEST(TrajectoryList, ASpeedInDoubtKeepsWhatWas) {
  TrajectoryList list = make_list();
  const auto without_points = [&](double moving_probability) {
    ObjectSight sight = sight_at(0.0, moving_probability, 1);
    sight.points_map.clear();
    return update(list, sight);
  };
  EXPECT_EQ(without_points(0.55), Mobility::at_rest);
  EXPECT_EQ(without_points(0.7), Mobility::moving);
  EXPECT_EQ(without_points(0.55), Mobility::moving);
}

TEST(TrajectoryList, MapsInTheObjectsFrameAndForgetsTheTimeAtRestWhenItStarts) {
  TrajectoryList list = make_list();
  for (std::uint64_t scan = 0; scan < 10; ++scan) update(list, sight_at(0.0, 0.1, scan));
  const std::size_t points_at_rest = list.maps().front().points_object.size();
  EXPECT_GT(points_at_rest, 200U);
  double x_m = 0.0;
  update(list, sight_at(x_m += 1.0, 0.99, 10));
  EXPECT_LT(list.maps().front().points_object.size(), points_at_rest);
  for (std::uint64_t scan = 11; scan < 20; ++scan) update(list, sight_at(x_m += 1.0, 0.99, scan));
  const std::vector<MappedObject> maps = list.maps();
  for (const Eigen::Vector3f& p : maps.front().points_object) {
    const double off_rear = std::abs(static_cast<double>(p.x()) + 0.5 * kSize.x());
    const double off_side = std::abs(static_cast<double>(p.y()) - 0.5 * kSize.y());
    EXPECT_LT(std::min(off_rear, off_side), 0.1);
  }
}

TEST(TrajectoryList, LendsTheMapOfWhatHasRestedLongEnough) {
  TrajectoryList list = make_list();
  update(list, sight_at(0.0, 0.1, 0));
  EXPECT_EQ(list.map_at_rest(car_at(0.0).translation()), nullptr) << "seen once";
  for (std::uint64_t scan = 1; scan < 10; ++scan) update(list, sight_at(0.0, 0.1, scan));
  const LocalMap* map = list.map_at_rest(car_at(0.3).translation());
  ASSERT_NE(map, nullptr);
  EXPECT_FALSE(map->empty());
  EXPECT_EQ(list.map_at_rest(car_at(5.0).translation()), nullptr) << "another place";
  update(list, sight_at(0.5, 0.99, 10));
  EXPECT_EQ(list.map_at_rest(car_at(0.5).translation()), nullptr) << "it moves";
}

TEST(TrajectoryList, HandsOutTheMapsOfWhatIsNoLongerFollowed) {
  TrajectoryList list = make_list();
  EXPECT_TRUE(list.update({}).empty());
  update(list, sight_at(0.0, 0.1, 0));
  EXPECT_TRUE(list.take_finished().empty());
  list.update({});
  const std::vector<MappedObject> finished = list.take_finished();
  ASSERT_EQ(finished.size(), 1U);
  EXPECT_EQ(finished.front().id, 7);
  EXPECT_FALSE(finished.front().points_object.empty());
  EXPECT_TRUE(list.maps().empty());
}

TEST(TrajectoryList, WithoutPointsTheSpeedDecides) {
  TrajectoryList list = make_list();
  for (const double probability : {0.2, 0.7, 0.3}) {
    ObjectSight sight = sight_at(0.0, probability, 1);
    sight.points_map.clear();
    EXPECT_EQ(update(list, sight), probability > 0.5 ? Mobility::moving : Mobility::at_rest);
  }
}

TEST(Displacement, RecoversAShift) {
  LocalMapConfig config;
  LocalMap map(config);
  for (std::uint64_t scan = 0; scan < 5; ++scan) map.insert(car_points(car_at(0.0), scan));
  for (const double x_m : {-0.25, 0.0, 0.05, 0.3}) {
    const Displacement found = measure_displacement(car_points(car_at(x_m), 99), map, {}, {});
    ASSERT_TRUE(found.known);
    const Eigen::Vector2d truth = (car_at(x_m).translation() - car_at(0.0).translation()).head<2>();
    EXPECT_LT((found.shift_map_m - truth).norm(), 0.03) << x_m;
  }
}

TEST(Displacement, IsUnsureAlongAFlatSide) {
  const auto wall = [](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<float> along(-20.0F, 20.0F);
    std::uniform_real_distribution<float> up(0.0F, 2.0F);
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 20000; ++i) points.emplace_back(along(random), 5.0F, up(random));
    return points;
  };
  LocalMap map((LocalMapConfig()));
  map.insert(wall(1));
  std::vector<Eigen::Vector3f> part;
  for (const Eigen::Vector3f& p : wall(2)) {
    if (std::abs(p.x()) < 3.0F) part.emplace_back(p + Eigen::Vector3f(0.4F, 0.0F, 0.0F));
  }
  const Displacement found = measure_displacement(part, map, {}, {});
  ASSERT_TRUE(found.known);
  EXPECT_GT(found.sd_m(), 0.2);
  EXPECT_LT(found.significance(), 4.0);
}

TEST(MotionBelief, ADisplacementCountsWhenTheMapAgrees) {
  Displacement displacement;
  displacement.known = true;
  displacement.shift_map_m = Eigen::Vector2d(0.1, 0.0);
  displacement.covariance = Eigen::Matrix2d::Identity() * std::pow(0.1 / 8.0, 2);
  displacement.fit_before = 0.7;
  displacement.fit_after = 0.9;
  constexpr double kSlow = 0.2;
  EXPECT_GT(motion_belief(kSlow, displacement, {.misfit = 0.4, .gain = 0.5}, {}), 0.0);
  EXPECT_LT(motion_belief(kSlow, displacement, {.misfit = 0.1, .gain = -0.1}, {}), 0.0) << "a new side";
  displacement.covariance *= 16.0;
  EXPECT_LT(motion_belief(kSlow, displacement, {.misfit = 0.4, .gain = 0.5}, {}), 0.0) << "noise";
}

std::vector<Eigen::Vector3f> car_map_points(std::uint64_t seed) {
  return car_points(SE3(), seed);
}

TEST(MapFit, WhatMovedTakesItsMapAlong) {
  LocalMap map((LocalMapConfig()));
  for (std::uint64_t scan = 0; scan < 5; ++scan) map.insert(car_points(car_at(0.0), scan));
  const std::vector<Eigen::Vector3f> now = car_points(car_at(0.3), 99);
  const Displacement found = measure_displacement(now, map, {}, {});
  ASSERT_TRUE(found.known);
  const MapFit fit = fit_map(car_map_points(7), car_at(0.0), now, found, {}, {});
  EXPECT_GT(fit.misfit, 0.2);
  EXPECT_GT(fit.gain, 0.5);
}

TEST(MapFit, WhatStandsDoesNot) {
  const std::vector<Eigen::Vector3f> now = car_points(car_at(0.0), 99);
  Displacement wrong;
  wrong.known = true;
  wrong.shift_map_m = Eigen::Vector2d(0.3, 0.0);
  wrong.center_map = car_at(0.0).translation();
  const MapFit fit = fit_map(car_map_points(7), car_at(0.0), now, wrong, {}, {});
  EXPECT_LT(fit.misfit, 0.1);
  EXPECT_LT(fit.gain, 0.0);
}

TEST(MapFit, UndoesATurnAboutTheCentreOfThePoints) {
  constexpr double kTurn_rad = 0.1;
  const SE3 turned = car_at(0.0) * SE3(so3_exp({0.0, 0.0, kTurn_rad}), Eigen::Vector3d::Zero());
  const std::vector<Eigen::Vector3f> now = car_points(turned, 99);
  Displacement displacement;
  displacement.known = true;
  displacement.turn_rad = kTurn_rad;
  displacement.center_map = car_at(0.0).translation();
  EXPECT_GT(fit_map(car_map_points(7), car_at(0.0), now, displacement, {}, {}).gain, 0.7);
}

TEST(MapFit, SaysNothingOfSidesThatAreNotSeen) {
  const std::vector<Eigen::Vector3f> elsewhere = car_points(car_at(50.0), 1);
  const MapFit fit = fit_map(car_map_points(7), car_at(0.0), elsewhere, {}, {}, {});
  EXPECT_EQ(fit.misfit, 0.0);
  EXPECT_EQ(fit.gain, 0.0);
  EXPECT_EQ(fit_map({}, car_at(0.0), elsewhere, {}, {}, {}).gain, 0.0);
}

TEST(Displacement, IsUnknownWithoutAMapOrPoints) {
  const LocalMap empty((LocalMapConfig()));
  EXPECT_FALSE(measure_displacement(car_points(car_at(0.0), 1), empty, {}, {}).known);
  EXPECT_FALSE(measure_displacement({}, empty, {}, {}).known);
}

}  // namespace
}  // namespace mlo
