#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "mlo/tracking/object_filter.hpp"
#include "tracking/boxes.hpp"

namespace mlo {
namespace {

using test::kDegree;
using test::kDt_s;
using test::placed_car;

BoxMeasurement measured(const PlacedBox& box) {
  return {.box = box,
          .along_sd_m = 0.1,
          .across_sd_m = 0.05,
          .height_sd_m = 0.05,
          .yaw_sd_rad = 2.0 * kDegree,
          .size_sd_m = {0.2, 0.1, 0.1}};
}

/// The filter after measurements of a car with this speed along x, with noise.
ObjectFilter follow(double speed_mps, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const ObjectMotionConfig config;
  ObjectFilter filter(measured(placed_car(0.0, 0.0)), true, config);
  for (int i = 1; i <= count; ++i) {
    filter.predict(kDt_s, config);
    PlacedBox box = placed_car(speed_mps * kDt_s * i + 0.1 * normal(random), 0.05 * normal(random));
    box.size_lwh_m.x() += 0.2 * normal(random);
    box.yaw_rad += 2.0 * kDegree * normal(random);
    filter.update(measured(box), config);
  }
  return filter;
}

TEST(ConfidenceLogit, IsCutAtBothEnds) {
  EXPECT_NEAR(confidence_logit(0.5), 0.0, 1e-12);
  EXPECT_NEAR(confidence_logit(1.0 / (1.0 + std::exp(-3.0))), 3.0, 1e-9);
  EXPECT_EQ(confidence_logit(1.0), 12.0);
  EXPECT_EQ(confidence_logit(0.0), -2.0);
  EXPECT_EQ(confidence_logit(std::nan("")), -2.0);
}

TEST(Measure, ConfidentBoxesAreBetter) {
  const BoxMeasurement sure = measure(test::car(10.0, 0.0, 0.0, 0.9999), SE3(), {});
  const BoxMeasurement unsure = measure(test::car(10.0, 0.0, 0.0, 0.5), SE3(), {});
  EXPECT_LT(sure.along_sd_m, unsure.along_sd_m);
  EXPECT_DOUBLE_EQ(unsure.along_sd_m, BoxNoiseConfig{}.along_m);
  EXPECT_LT(sure.yaw_sd_rad, unsure.yaw_sd_rad);
}

TEST(ObjectFilter, StandingCarsAreKnownToStand) {
  const ObjectFilter filter = follow(0.0, 40, 1);
  EXPECT_LT(filter.moving_probability(), 0.2);
  EXPECT_LT(filter.velocity_mps().norm(), 0.1);
  EXPECT_LT(filter.box().center_map_m.head<2>().norm(), 0.1) << "better than one measurement";
}

TEST(ObjectFilter, MovingCarsGetTheirVelocity) {
  const ObjectFilter filter = follow(12.0, 40, 2);
  EXPECT_GT(filter.moving_probability(), 0.99);
  EXPECT_NEAR(filter.velocity_mps().x(), 12.0, 0.5);
  EXPECT_NEAR(filter.velocity_mps().y(), 0.0, 0.3);
  EXPECT_NEAR(filter.box().center_map_m.x(), 48.0, 0.15);
}

TEST(ObjectFilter, ErrorsAgreeWithTheCovariance) {
  double normalised = 0.0;
  constexpr int kRuns = 50;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    const ObjectFilter filter = follow(8.0, 30, 100 + seed);
    ObjectFilter::Vector4d error;
    error << filter.box().center_map_m.head<2>() - Eigen::Vector2d(24.0, 0.0),
        filter.velocity_mps() - Eigen::Vector2d(8.0, 0.0);
    normalised += error.dot(filter.planar_covariance().inverse() * error) / kRuns;
  }
  // The expectation is 4 for a consistent filter; this one allows for accelerations that do not happen here.
  EXPECT_LT(normalised, 6.0);
  EXPECT_GT(normalised, 0.4);
}

TEST(ObjectFilter, StoppingAndStartingAreFollowed) {
  const ObjectMotionConfig config;
  ObjectFilter filter(measured(placed_car(0.0, 0.0)), true, config);
  double x_m = 0.0;
  const auto drive = [&](double speed_mps, int scans) {
    for (int i = 0; i < scans; ++i) {
      x_m += speed_mps * kDt_s;
      filter.predict(kDt_s, config);
      filter.update(measured(placed_car(x_m, 0.0)), config);
    }
  };
  drive(5.0, 20);
  EXPECT_GT(filter.moving_probability(), 0.95);
  drive(0.0, 30);
  EXPECT_LT(filter.moving_probability(), 0.2);
  EXPECT_NEAR(filter.box().center_map_m.x(), x_m, 0.05);
  drive(5.0, 20);
  EXPECT_GT(filter.moving_probability(), 0.95);
  EXPECT_NEAR(filter.box().center_map_m.x(), x_m, 0.1);
}

TEST(ObjectFilter, AFlippedHeadingIsTurnedRound) {
  const ObjectMotionConfig config;
  ObjectFilter filter(measured(placed_car(0.0, 0.0, 10.0 * kDegree)), true, config);
  for (int i = 1; i <= 9; ++i) {
    filter.predict(kDt_s, config);
    const bool flipped = i % 4 == 0;
    filter.update(measured(placed_car(0.0, 0.0, (flipped ? -170.0 : 10.0) * kDegree)), config);
    EXPECT_NEAR(filter.box().yaw_rad, 10.0 * kDegree, 1.0 * kDegree) << "scan " << i;
  }
}

TEST(ObjectFilter, AWrongFirstHeadingIsOutvoted) {
  const ObjectMotionConfig config;
  ObjectFilter filter(measured(placed_car(0.0, 0.0, -170.0 * kDegree)), true, config);
  for (int i = 1; i <= 5; ++i) {
    filter.predict(kDt_s, config);
    filter.update(measured(placed_car(0.0, 0.0, 10.0 * kDegree)), config);
  }
  EXPECT_NEAR(filter.box().yaw_rad, 10.0 * kDegree, 1.0 * kDegree);
}

TEST(ObjectFilter, CarsDriveForwards) {
  const ObjectMotionConfig config;
  ObjectFilter filter(measured(placed_car(0.0, 0.0, 180.0 * kDegree)), true, config);
  for (int i = 1; i <= 15; ++i) {
    filter.predict(kDt_s, config);
    filter.update(measured(placed_car(1.0 * i, 0.0, 180.0 * kDegree)), config);  // 10 m/s along x
  }
  EXPECT_NEAR(wrapped_angle(filter.box().yaw_rad), 0.0, 3.0 * kDegree);
}

TEST(ObjectFilter, TheSizeSettles) {
  const ObjectFilter early = follow(0.0, 2, 7);
  const ObjectFilter late = follow(0.0, 100, 7);
  EXPECT_NEAR(late.box().size_lwh_m.x(), 4.0, 0.08);
  EXPECT_LT(std::abs(late.box().size_lwh_m.x() - 4.0), std::abs(early.box().size_lwh_m.x() - 4.0) + 0.02);
}

TEST(ObjectFilter, OneOutlierMovesItLittle) {
  const ObjectMotionConfig config;
  ObjectFilter filter = follow(0.0, 40, 3);
  filter.predict(kDt_s, config);
  filter.update(measured(placed_car(2.0, 0.0)), config);
  EXPECT_LT(std::abs(filter.box().center_map_m.x()), 0.4);
}

TEST(ObjectFilter, ATurnGivesARate) {
  const ObjectMotionConfig config;
  const double rate_radps = 20.0 * kDegree;
  constexpr double kSpeed_mps = 6.0;
  ObjectFilter filter(measured(placed_car(0.0, 0.0)), true, config);
  for (int i = 1; i <= 40; ++i) {
    const double yaw = rate_radps * kDt_s * i;
    const double radius_m = kSpeed_mps / rate_radps;
    filter.predict(kDt_s, config);
    filter.update(measured(placed_car(radius_m * std::sin(yaw), radius_m * (1.0 - std::cos(yaw)), yaw)),
                  config);
  }
  EXPECT_NEAR(filter.turn_rate_radps(), rate_radps, 3.0 * kDegree);
  EXPECT_NEAR(filter.velocity_mps().norm(), kSpeed_mps, 0.5);
}

}  // namespace
}  // namespace mlo
