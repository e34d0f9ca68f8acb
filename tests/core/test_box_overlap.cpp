#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "mlo/core/box_overlap.hpp"

namespace mlo {
namespace {

constexpr double kPi = std::numbers::pi;

Box3d box(const Eigen::Vector3d& center_m, const Eigen::Vector3d& size_m, double yaw_rad) {
  return {center_m, size_m, yaw_rad};
}

TEST(BoxOverlap, ImageBoxesOfKnownOverlap) {
  const Box2d a{0, 0, 10, 10};
  EXPECT_DOUBLE_EQ(intersection_over_union(a, a), 1.0);
  EXPECT_DOUBLE_EQ(intersection_over_union(a, Box2d{5, 0, 15, 10}), 50.0 / 150.0);
  EXPECT_DOUBLE_EQ(intersection_over_union(a, Box2d{10, 0, 20, 10}), 0.0);
  EXPECT_DOUBLE_EQ(intersection_over_union(a, Box2d{20, 20, 30, 30}), 0.0);
  EXPECT_DOUBLE_EQ(intersection_over_union(a, Box2d{3, 3, 3, 9}), 0.0);
  EXPECT_DOUBLE_EQ(intersection_over_union(Box2d{}, Box2d{}), 0.0);
  EXPECT_DOUBLE_EQ(covered_fraction(a, Box2d{5, 5, 100, 100}), 0.25);
  EXPECT_DOUBLE_EQ(covered_fraction(Box2d{5, 5, 100, 100}, a), 25.0 / (95.0 * 95.0));
  EXPECT_DOUBLE_EQ(covered_fraction(Box2d{}, a), 0.0);
}

TEST(BoxOverlap, BoxesOfKnownOverlap) {
  const Box3d a = box({0, 0, 0}, {4, 2, 1.5}, 0.3);
  EXPECT_NEAR(intersection_over_union(a, a), 1.0, 1e-12);
  EXPECT_NEAR(intersection_over_union(a, box({0, 0, 0}, {4, 2, 1.5}, 0.3 + kPi)), 1.0, 1e-12);
  EXPECT_NEAR(intersection_over_union(a, box({0, 0, 0.75}, {4, 2, 1.5}, 0.3)), 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(intersection_over_union(a, box({0, 0, 0}, {2, 1, 0.75}, 0.3)), 1.0 / 8.0, 1e-12);
  EXPECT_EQ(intersection_over_union(a, box({0, 0, 2.0}, {4, 2, 1.5}, 0.3)), 0.0);
  EXPECT_EQ(intersection_over_union(a, box({50, 0, 0}, {4, 2, 1.5}, 0.3)), 0.0);
  EXPECT_EQ(intersection_over_union(a, box({0, 0, 0}, {0, 2, 1.5}, 0.3)), 0.0);
  EXPECT_EQ(intersection_over_union(a, box({0, 0, 0}, {-1000, -1000, -1000}, 0.3)), 0.0);
  // A square turned by 45 degrees in a square: a regular octagon, 2 (sqrt 2 - 1) of its area.
  const double octagon = 2.0 * (std::sqrt(2.0) - 1.0);
  EXPECT_NEAR(
      intersection_over_union(box({1, 2, 3}, {1, 1, 1}, 0.1), box({1, 2, 3}, {1, 1, 1}, 0.1 + kPi / 4)),
      octagon / (2.0 - octagon), 1e-12);
  // A cross of two bars.
  EXPECT_NEAR(intersection_over_union(box({0, 0, 0}, {4, 1, 1}, 0.0), box({0, 0, 0}, {4, 1, 1}, kPi / 2)),
              1.0 / 7.0, 1e-12);
}

TEST(BoxOverlap, FootprintsDoNotLookAtHeights) {
  const Box3d a = box({0, 0, 0}, {4, 2, 1.5}, 0.3);
  EXPECT_NEAR(footprint_iou(a, box({0, 0, 9}, {4, 2, 0.5}, 0.3)), 1.0, 1e-12);
  EXPECT_NEAR(footprint_iou(box({0, 0, 0}, {4, 1, 1}, 0.0), box({0, 0, 0}, {4, 1, 1}, kPi / 2)), 1.0 / 7.0,
              1e-12);
  EXPECT_EQ(footprint_iou(a, box({50, 0, 0}, {4, 2, 1.5}, 0.3)), 0.0);
  EXPECT_EQ(footprint_iou(a, box({0, 0, 0}, {0, 2, 1.5}, 0.3)), 0.0);
}

TEST(BoxOverlap, EqualsCountingPoints) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Box3d a = box({0, 0, 0}, {4.0, 1.8, 1.5}, kPi * uniform(rng));
    const Box3d b =
        box({1.5 * uniform(rng), uniform(rng), 0.5 * uniform(rng)}, {3.5, 2.0, 1.4}, kPi * uniform(rng));
    std::size_t both = 0;
    std::size_t any = 0;
    std::size_t both_above = 0;
    std::size_t any_above = 0;
    for (int i = 0; i < 40000; ++i) {
      const Eigen::Vector3d p(5.0 * uniform(rng), 5.0 * uniform(rng), 2.0 * uniform(rng));
      const bool in_a = a.contains(p);
      const bool in_b = b.contains(p);
      both += in_a && in_b ? 1 : 0;
      any += in_a || in_b ? 1 : 0;
      const Eigen::Vector3d above_a(p.x(), p.y(), a.center_lidar_m.z());
      const Eigen::Vector3d above_b(p.x(), p.y(), b.center_lidar_m.z());
      both_above += a.contains(above_a) && b.contains(above_b) ? 1 : 0;
      any_above += a.contains(above_a) || b.contains(above_b) ? 1 : 0;
    }
    EXPECT_NEAR(intersection_over_union(a, b), static_cast<double>(both) / static_cast<double>(any), 0.04);
    EXPECT_NEAR(footprint_iou(a, b), static_cast<double>(both_above) / static_cast<double>(any_above), 0.04);
    EXPECT_NEAR(intersection_over_union(a, b), intersection_over_union(b, a), 1e-12);
  }
}

}  // namespace
}  // namespace mlo
