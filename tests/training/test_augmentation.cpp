#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "made_example.hpp"
#include "mlo/core/box_overlap.hpp"
#include "mlo/training/augmentation.hpp"

namespace mlo {
namespace {

using test::made_example;
using test::made_label;
using test::made_street;

constexpr double kPi = std::numbers::pi;
constexpr double kFloat_m = 1e-5;  // rounding of a float at 50 m

void expect_equal(const TrainingExample& a, const TrainingExample& b, double tolerance = 0.0) {
  ASSERT_EQ(a.points.size(), b.points.size());
  ASSERT_EQ(a.boxes.size(), b.boxes.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    ASSERT_LE((a.points[i].p_lidar - b.points[i].p_lidar).norm(), static_cast<float>(tolerance));
    ASSERT_EQ(a.points[i].intensity, b.points[i].intensity);
  }
  for (std::size_t i = 0; i < a.boxes.size(); ++i) {
    EXPECT_EQ(a.boxes[i].type, b.boxes[i].type);
    EXPECT_LE((a.boxes[i].box.center_lidar_m - b.boxes[i].box.center_lidar_m).norm(), tolerance);
    EXPECT_LE((a.boxes[i].box.size_lwh_m - b.boxes[i].box.size_lwh_m).norm(), tolerance);
    EXPECT_LE(std::abs(a.boxes[i].box.yaw_rad - b.boxes[i].box.yaw_rad), tolerance);
  }
}

/// All counts are still true.
void expect_points_in_boxes(const TrainingExample& example) {
  for (const TrainingBox& label : example.boxes) {
    EXPECT_EQ(count_within(example.points, label.box), label.points);
    EXPECT_GT(label.points, 0U);
  }
}

AugmentationConfig nothing() {
  AugmentationConfig config;
  config.sampling = {.cars = 0, .vans = 0, .trucks = 0, .pedestrians = 0, .cyclists = 0};
  config.object_noise.probability = 0.0;
  config.flip_probability = 0.0;
  config.max_rotation_deg = 0.0;
  config.max_scaling = 0.0;
  return config;
}

TEST(Flip, ExchangesLeftAndRight) {
  const TrainingExample before = made_example({made_label("car", 10.0, 5.0, 0.3)});
  const TrainingExample after = flipped(before);
  EXPECT_EQ(after.boxes[0].box.center_lidar_m.y(), -5.0);
  EXPECT_EQ(after.boxes[0].box.yaw_rad, -0.3);
  expect_points_in_boxes(after);
  expect_equal(flipped(after), before);
}

TEST(Rotation, TurnsPointsAndBoxesAlike) {
  const TrainingExample before = made_example({made_label("car", 10.0, 0.0, 3.0)});
  const TrainingExample quarter = rotated(before, 0.5 * kPi);
  EXPECT_NEAR(quarter.boxes[0].box.center_lidar_m.y(), 10.0, 1e-12);
  EXPECT_NEAR(quarter.boxes[0].box.yaw_rad, 3.0 + 0.5 * kPi - 2.0 * kPi, 1e-12);
  expect_points_in_boxes(quarter);
  expect_equal(rotated(quarter, -0.5 * kPi), before, kFloat_m);
}

TEST(Scaling, ScalesPointsAndBoxesAlike) {
  const TrainingExample before = made_street(4);
  const TrainingExample larger = scaled(before, 1.25);
  EXPECT_NEAR(larger.boxes[0].box.size_lwh_m.x(), 5.0, 1e-12);
  expect_points_in_boxes(larger);
  expect_equal(scaled(larger, 0.8), before, kFloat_m);
}

TEST(ObjectNoise, MovesObjectsWithTheirPoints) {
  const TrainingExample before = made_street(5);
  Random random(1);
  const TrainingExample after =
      with_object_noise(before, {.probability = 1.0, .position_m = 0.5, .max_turn_deg = 20.0}, random);
  expect_points_in_boxes(after);
  for (std::size_t i = 0; i < before.boxes.size(); ++i) {
    EXPECT_GT((after.boxes[i].box.center_lidar_m - before.boxes[i].box.center_lidar_m).norm(), 0.0);
    EXPECT_EQ(after.boxes[i].box.center_lidar_m.z(), before.boxes[i].box.center_lidar_m.z());
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_EQ(footprint_iou(after.boxes[i].box, after.boxes[j].box), 0.0);
    }
  }
}

TEST(ObjectNoise, LeavesThoseThatShareGround) {
  const TrainingExample before =
      made_example({made_label("car", 10.0, 0.0, 0.0), made_label("car", 12.0, 0.5, 0.3)});
  Random random(1);
  expect_equal(with_object_noise(before, {.probability = 1.0}, random), before);
}

TEST(Augment, NothingIsTheIdentity) {
  const TrainingExample before = made_street(1);
  ObjectBank bank;
  bank.add(made_street(2));
  expect_equal(augment(before, bank, nothing(), 3), before);
}

TEST(Augment, KeepsTheLawsForManySeeds) {
  ObjectBank bank;
  for (std::uint64_t i = 0; i < 10; ++i) bank.add(made_street(50 + i));
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const TrainingExample after = augment(made_street(seed), bank, AugmentationConfig{}, seed);
    EXPECT_GT(after.boxes.size(), 8U);
    expect_points_in_boxes(after);
    for (std::size_t i = 0; i < after.boxes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_LT(footprint_iou(after.boxes[i].box, after.boxes[j].box), 1e-9);
      }
    }
    for (const Point& point : after.points) ASSERT_TRUE(point.p_lidar.allFinite());
  }
}

TEST(Augment, EachStepDoesSomethingAlone) {
  const TrainingExample before = made_street(1);
  ObjectBank bank;
  for (std::uint64_t i = 0; i < 5; ++i) bank.add(made_street(50 + i));
  AugmentationConfig flip = nothing();
  flip.flip_probability = 1.0;
  expect_equal(augment(before, bank, flip, 1), flipped(before));
  AugmentationConfig rotation = nothing();
  rotation.max_rotation_deg = 45.0;
  const double turn = augment(before, bank, rotation, 1).boxes[0].box.yaw_rad - before.boxes[0].box.yaw_rad;
  EXPECT_NE(turn, 0.0);
  EXPECT_LE(std::abs(std::remainder(turn, 2.0 * kPi)), 0.25 * kPi);
  AugmentationConfig scaling = nothing();
  scaling.max_scaling = 0.1;
  const double factor = augment(before, bank, scaling, 1).boxes[0].box.size_lwh_m.x() / 4.0;
  EXPECT_NE(factor, 1.0);
  EXPECT_NEAR(factor, 1.0, 0.1);
  AugmentationConfig sampling = nothing();
  sampling.sampling.cars = 6;
  EXPECT_EQ(augment(before, bank, sampling, 1).boxes.size(), before.boxes.size() + 2);
  AugmentationConfig noise = nothing();
  noise.object_noise.probability = 1.0;
  EXPECT_NE(augment(before, bank, noise, 1).boxes[0].box.yaw_rad, before.boxes[0].box.yaw_rad);
}

TEST(Augment, SameSeedSameExampleAnotherSeedAnother) {
  ObjectBank bank;
  for (std::uint64_t i = 0; i < 5; ++i) bank.add(made_street(50 + i));
  const TrainingExample before = made_street(1);
  const TrainingExample once = augment(before, bank, AugmentationConfig{}, 7);
  expect_equal(augment(before, bank, AugmentationConfig{}, 7), once);
  EXPECT_NE(augment(before, bank, AugmentationConfig{}, 8).boxes[0].box.yaw_rad, once.boxes[0].box.yaw_rad);
}

TEST(Augment, EmptyAndWithoutBoxes) {
  const TrainingExample empty = augment({}, ObjectBank(), AugmentationConfig{}, 1);
  EXPECT_TRUE(empty.points.empty());
  EXPECT_TRUE(empty.boxes.empty());
  const TrainingExample ground = made_example({});
  const TrainingExample after = augment(ground, ObjectBank(), AugmentationConfig{}, 1);
  EXPECT_EQ(after.points.size(), ground.points.size());
  EXPECT_TRUE(after.boxes.empty());
}

}  // namespace
}  // namespace mlo
