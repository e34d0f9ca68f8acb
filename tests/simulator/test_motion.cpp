#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mlo/simulator/motion.hpp"
#include "mlo/simulator/path.hpp"
#include "mlo/simulator/terrain.hpp"
#include "mlo/simulator/traffic.hpp"

namespace mlo::simulator {
namespace {

constexpr double kPi = std::numbers::pi;

Path bend() {
  return Path(PathPoint{}, {{40.0, 0.0}, {0.5 * kPi * 12.0, 1.0 / 12.0}, {40.0, 0.0}}, 6.0);
}

TEST(Path, TurnsByTheAngleOfItsPiecesAndKeepsItsLength) {
  const Path path = bend();
  EXPECT_NEAR(path.at(path.length_m()).heading_rad, 0.5 * kPi, 0.01);
  EXPECT_NEAR(path.length_m(), 80.0 + 0.5 * kPi * 12.0, 0.3);
}

TEST(Path, ArcLengthIsLengthAlongTheCurve) {
  const Path path = bend();
  for (double s = 0.0; s < path.length_m() - 1.0; s += 0.37) {
    EXPECT_NEAR((path.at(s + 0.1).p_world - path.at(s).p_world).norm(), 0.1, 1e-3);
  }
}

TEST(Path, OffsetKeepsItsDistanceAndReversedRunsBack) {
  const Path path = bend();
  const Path left = path.offset(3.0);
  EXPECT_LT(left.length_m(), path.length_m());  // the inside of a left bend
  EXPECT_NEAR(left.length_m(), path.length_m() - 3.0 * 0.5 * kPi, 0.1);
  const Path back = path.reversed();
  EXPECT_NEAR((back.at(10.0).p_world - path.at(path.length_m() - 10.0).p_world).norm(), 0.0, 1e-6);
}

TEST(Path, GoesOnStraightBeyondItsEnds) {
  const Path path = straight({1.0, 2.0}, 0.5 * kPi, 10.0);
  EXPECT_NEAR((path.at(15.0).p_world - Eigen::Vector2d(1.0, 17.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((path.at(-3.0).p_world - Eigen::Vector2d(1.0, -1.0)).norm(), 0.0, 1e-9);
}

TEST(Motion, VelocityIsTheDerivativeOfPosition) {
  const Motion motion = glide(bend(), 7.0, 0.5);
  constexpr double kStep = 1e-3;
  for (double t = 1.0; t < motion.duration_s() - 1.0; t += 0.31) {
    const Eigen::Vector2d difference =
        (motion.at(t + kStep).p_world - motion.at(t - kStep).p_world) / (2.0 * kStep);
    EXPECT_NEAR((difference - motion.at(t).velocity_mps()).norm(), 0.0, 0.05) << "at " << t;
    const double turned = (motion.at(t + kStep).yaw_rad - motion.at(t - kStep).yaw_rad) / (2.0 * kStep);
    EXPECT_NEAR(turned, motion.at(t).yaw_rate_radps, 0.05) << "at " << t;
  }
}

TEST(Motion, GlideWaitsThenStopsAtTheEnd) {
  const Path path = straight({0.0, 0.0}, 0.0, 20.0);
  const Motion motion = glide(path, 2.0, 3.0);
  EXPECT_NEAR(motion.at(2.9).p_world.x(), 0.0, 1e-9);
  EXPECT_NEAR(motion.at(100.0).p_world.x(), 20.0, 0.2);
  EXPECT_EQ(motion.at(100.0).speed_mps, 0.0);
}

TEST(Motion, ReversingFacesAgainstTheWay) {
  const Motion motion = glide(straight({0.0, 0.0}, 0.0, 10.0), 1.0, 0.0, true);
  EXPECT_NEAR(std::cos(motion.at(5.0).yaw_rad), -1.0, 1e-9);
  EXPECT_LT(motion.at(5.0).speed_mps, 0.0);
  EXPECT_GT(motion.at(5.0).velocity_mps().x(), 0.0);
}

TEST(Motion, JoinedMotionsContinueInPlaceAndAngle) {
  const Motion first = glide(straight({0.0, 0.0}, 0.0, 10.0), 1.0, 0.0, true);
  const PlanarState end = first.states().back();
  const Motion both = first.then(glide(straight(end.p_world, end.yaw_rad - 2.0 * kPi, 5.0), 1.0, 1.0));
  for (std::size_t i = 1; i < both.states().size(); ++i) {
    EXPECT_LT((both.states()[i].p_world - both.states()[i - 1].p_world).norm(), 0.1);
    EXPECT_LT(std::abs(both.states()[i].yaw_rad - both.states()[i - 1].yaw_rad), 0.1);
  }
}

TEST(Motion, EmptyMotionRestsAtTheOrigin) {
  EXPECT_EQ(Motion().at(3.0).p_world, Eigen::Vector2d::Zero());
  EXPECT_EQ(Motion().duration_s(), 0.0);
}

TEST(Terrain, GradientIsTheSlopeOfItsHeight) {
  Terrain terrain;
  terrain.waves = {{{0.03, 0.01}, 1.5, 0.3}, {{-0.02, 0.05}, 0.7, 1.0}};
  const Eigen::Vector2d p(12.0, -7.0);
  constexpr double kStep = 1e-5;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d d = kStep * Eigen::Vector2d::Unit(axis);
    EXPECT_NEAR((terrain.height(p + d) - terrain.height(p - d)) / (2.0 * kStep), terrain.gradient(p)[axis],
                1e-8);
  }
  EXPECT_NEAR(
      (stand_on(terrain, p, 0.7).rotation() * Eigen::Vector3d::UnitX()).z(),
      (stand_on(terrain, p + 1e-4 * Eigen::Vector2d(std::cos(0.7), std::sin(0.7)), 0.7).translation() -
       stand_on(terrain, p, 0.7).translation())
          .normalized()
          .z(),
      1e-4);
}

std::vector<Driver> platoon() {
  const auto fast = [](double) { return 14.0; };
  const auto slow = [](double) { return 9.0; };
  return {{60.0, 4.5, 9.0, slow}, {45.0, 12.0, 12.0, fast}, {30.0, 4.5, 12.0, fast}, {10.0, 4.5, 12.0, fast}};
}

TEST(Traffic, NobodyRunsIntoTheVehicleAhead) {
  const std::vector<Driver> drivers = platoon();
  const RedLight light{.s_m = 200.0, .period_s = 30.0, .red_s = 20.0, .phase_s = 5.0};
  const std::vector<Motion> motions =
      drive_lane(straight({0.0, 0.0}, 0.0, 600.0), drivers, {light}, {}, 60.0);
  for (std::size_t step = 0; step < motions[0].states().size(); ++step) {
    for (std::size_t i = 1; i < motions.size(); ++i) {
      const double gap = motions[i - 1].states()[step].p_world.x() - motions[i].states()[step].p_world.x() -
                         0.5 * (drivers[i - 1].length_m + drivers[i].length_m);
      ASSERT_GT(gap, 0.5) << "vehicle " << i << " at step " << step;
    }
  }
}

TEST(Traffic, VehiclesStopAtRedAndGoOnAtGreen) {
  const RedLight light{.s_m = 100.0, .period_s = 60.0, .red_s = 25.0, .phase_s = 0.0};
  const std::vector<Motion> motions = drive_lane(
      straight({0.0, 0.0}, 0.0, 400.0), {{20.0, 4.0, 10.0, [](double) { return 10.0; }}}, {light}, {}, 45.0);
  EXPECT_LT(motions[0].at(24.0).p_world.x(), 98.0);
  EXPECT_LT(motions[0].at(24.0).speed_mps, 0.2);
  EXPECT_GT(motions[0].at(44.0).p_world.x(), 110.0);
}

TEST(Traffic, SpeedInBendsKeepsToTheLateralLimit) {
  TrafficRules rules;
  const Path path = bend();
  const std::vector<Motion> motions =
      drive_lane(path, {{0.0, 4.0, 10.0, [](double) { return 14.0; }}}, {}, rules, 30.0);
  for (const PlanarState& state : motions[0].states()) {
    EXPECT_LT(std::abs(state.speed_mps * state.yaw_rate_radps), 1.3 * rules.max_lateral_mps2);
  }
}

TEST(RobotMotion, PoseIsSmoothAndStandsOnTheGround) {
  RobotMotion robot;
  robot.planar = cruise(bend(), 0.0, 8.0, 10.0);
  Terrain terrain;
  terrain.waves = {{{0.04, 0.02}, 1.0, 0.0}};
  for (double t = 0.1; t < 9.0; t += 0.01) {
    const SE3 step = robot.T_world_lidar(terrain, t).inverse() * robot.T_world_lidar(terrain, t + 0.01);
    EXPECT_NEAR(step.translation().norm(), 0.08, 0.01);
    EXPECT_LT(step.rotation_angle_rad(), 0.012);
    const Eigen::Vector3d p = robot.T_world_lidar(terrain, t).translation();
    EXPECT_NEAR(p.z() - terrain.height(p.head<2>()), robot.lidar_height_m, 0.05);
  }
}

}  // namespace
}  // namespace mlo::simulator
