#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "mlo/core/sweep_motion.hpp"

namespace mlo {
namespace {

SE3 turn(double yaw_deg, double roll_deg = 0.0) {
  return {so3_exp(Eigen::Vector3d(roll_deg, 0.0, yaw_deg) * (std::numbers::pi / 180.0)), {2.0, 0.3, -0.1}};
}

TEST(SweepMotion, UndistortIsTheExponentialToAMillimetre) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> fraction(0.0, 1.0);
  std::normal_distribution<double> normal;
  for (const double reference_fraction : {0.0, 0.5, 1.0}) {
    const SweepMotion motion(turn(5.9, 1.0), reference_fraction);
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3d p =
          50.0 * Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      const double s = fraction(random);
      EXPECT_LT((motion.undistort(p, s) - motion.T_reference_at(s) * p).norm(), 0.001);
    }
  }
}

TEST(SweepMotion, PointsOfTheReferenceTimeStay) {
  const SweepMotion motion(turn(6.0), 0.3);
  EXPECT_EQ(motion.reference_fraction(), 0.3);
  EXPECT_EQ(motion.undistort({10.0, 20.0, 1.0}, 0.3), Eigen::Vector3d(10.0, 20.0, 1.0));
}

TEST(SweepMotion, FromStartToEndIsTheMotionOfASweep) {
  const SE3 motion_per_sweep = turn(4.0, -2.0);
  const SweepMotion motion(motion_per_sweep, 0.5);
  const SE3 T_start_end = motion.T_reference_at(0.0).inverse() * motion.T_reference_at(1.0);
  EXPECT_LT((T_start_end.matrix() - motion_per_sweep.matrix()).norm(), 1e-12);
}

TEST(SweepMotion, AnIncrementOverAGapIsSharedByItsSweeps) {
  const SE3 per_sweep = turn(1.5);
  const SE3 increment = interpolate(per_sweep, 4.0);
  const SweepMotion motion =
      SweepMotion::from_increment(increment, {.reference_fraction = 1.0, .sweeps_since_previous = 4.0});
  EXPECT_EQ(motion.reference_fraction(), 1.0);
  const SE3 expected = per_sweep.inverse();  // start of the sweep as seen from its end
  EXPECT_LT((motion.T_reference_at(0.0).matrix() - expected.matrix()).norm(), 1e-12);
}

TEST(SweepMotion, CompensatedScansAreLeftAsTheyAre) {
  const SweepMotion motion = SweepMotion::from_increment(turn(5.0), {.motion_compensated = true});
  for (const double s : {0.0, 0.4, 1.0}) {
    EXPECT_EQ(motion.undistort({10.0, -20.0, 1.0}, s), Eigen::Vector3d(10.0, -20.0, 1.0));
    EXPECT_EQ(SweepMotion::none().T_reference_at(s).matrix(), Eigen::Matrix4d::Identity());
  }
}

}  // namespace
}  // namespace mlo
