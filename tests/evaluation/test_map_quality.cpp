#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "mlo/evaluation/map_quality.hpp"

namespace mlo {
namespace {

using Points = std::vector<Eigen::Vector3f>;

// A wall of 8 m x 8 m at x = offset_m, with Gaussian noise across it.
Points wall(std::size_t count, double sigma_m, double offset_m, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> along(-4.0, 4.0);
  std::normal_distribution<double> across(0.0, 1.0);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(Eigen::Vector3d(offset_m + sigma_m * across(rng), along(rng), along(rng)).cast<float>());
  }
  return points;
}

Points random_cube(std::size_t count, double half_m) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> uniform(-half_m, half_m);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng)).cast<float>());
  }
  return points;
}

TEST(MapQuality, ThicknessOfAWallIsItsNoise) {
  for (const double sigma_m : {0.005, 0.02, 0.05}) {
    const MapQuality quality = map_quality(wall(10000, sigma_m, 3.0, 1));
    EXPECT_EQ(quality.num_points, 10000U);
    EXPECT_GT(quality.num_planar, quality.num_samples / 2);
    EXPECT_NEAR(quality.plane_residual_mean_m.value(), sigma_m, 0.05 * sigma_m);
    EXPECT_NEAR(quality.plane_residual_median_m.value(), sigma_m, 0.05 * sigma_m);
  }
}

TEST(MapQuality, AWallSeenTwiceFromWrongPosesIsWorse) {
  Points sharp = wall(10000, 0.01, 3.0, 1);
  Points doubled = sharp;
  for (const Eigen::Vector3f& point : wall(10000, 0.01, 3.0, 2)) sharp.push_back(point);
  for (const Eigen::Vector3f& point : wall(10000, 0.01, 3.06, 2)) doubled.push_back(point);
  const MapQuality good = map_quality(sharp);
  const MapQuality bad = map_quality(doubled);
  EXPECT_GT(bad.plane_residual_mean_m.value(), 2.0 * good.plane_residual_mean_m.value());
  EXPECT_GT(bad.mean_entropy.value(), good.mean_entropy.value() + 0.5);
}

TEST(MapQuality, EntropyOfAGaussianIsTheFormula) {
  // All of a small Gaussian cluster is in everyone's neighbourhood.
  std::mt19937 rng(6);
  std::normal_distribution<double> normal(0.0, 0.05);
  Points points;
  for (int i = 0; i < 3000; ++i)
    points.push_back(Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).cast<float>());
  const MapQuality quality = map_quality(points, {.radius_m = 2.0});
  const double expected = 1.5 * std::log(2.0 * std::numbers::pi * std::numbers::e * (0.05 * 0.05 + 1e-6));
  EXPECT_NEAR(quality.mean_entropy.value(), expected, 0.06);
  EXPECT_EQ(quality.num_samples, 3000U);
  EXPECT_EQ(quality.num_planar, 0U);
}

TEST(MapQuality, EqualsBruteForce) {
  const Points points = random_cube(600, 1.0);
  const MapQualityOptions options{.radius_m = 0.4, .max_flatness = 0.5};
  double entropy_sum = 0.0;
  double thickness_sum = 0.0;
  std::size_t samples = 0;
  std::size_t planar = 0;
  for (const Eigen::Vector3f& center : points) {
    std::vector<Eigen::Vector3d> near;
    for (const Eigen::Vector3f& point : points) {
      if ((point - center).squaredNorm() < 0.16F) near.push_back(point.cast<double>());
    }
    if (near.size() < options.min_neighbors) continue;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : near) mean += p / static_cast<double>(near.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& p : near) {
      covariance += (p - mean) * (p - mean).transpose() / static_cast<double>(near.size());
    }
    const Eigen::Vector3d l = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues();
    const Eigen::Matrix3d floored = covariance + 1e-6 * Eigen::Matrix3d::Identity();
    entropy_sum += 0.5 * std::log((2.0 * std::numbers::pi * std::numbers::e * floored).determinant());
    ++samples;
    if (l(0) < 0.5 * l(1) && l(1) > 0.1 * l(2)) {
      ++planar;
      thickness_sum += std::sqrt(l(0));
    }
  }
  ASSERT_GT(planar, 20U);
  const MapQuality quality = map_quality(points, options);
  EXPECT_EQ(quality.num_samples, samples);
  EXPECT_EQ(quality.num_planar, planar);
  EXPECT_NEAR(quality.mean_entropy.value(), entropy_sum / static_cast<double>(samples), 1e-6);
  EXPECT_NEAR(quality.plane_residual_mean_m.value(), thickness_sum / static_cast<double>(planar), 1e-6);
}

TEST(MapQuality, LinesAreNotPlanes) {
  Points line;
  for (int i = 0; i < 1000; ++i) line.emplace_back(0.01F * static_cast<float>(i), 0.0F, 0.0F);
  const MapQuality quality = map_quality(line);
  EXPECT_EQ(quality.num_planar, 0U);
  EXPECT_FALSE(quality.plane_residual_mean_m);
  EXPECT_TRUE(std::isfinite(quality.mean_entropy.value()));
}

TEST(MapQuality, SparseEmptyDuplicatesAndNan) {
  EXPECT_FALSE(map_quality({}).mean_entropy);
  EXPECT_FALSE(map_quality(Points{Eigen::Vector3f::Zero()}).mean_entropy);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Points points(20, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  points.emplace_back(nan, 0.0F, 0.0F);
  const MapQuality quality = map_quality(points);
  EXPECT_EQ(quality.num_points, 20U);
  EXPECT_EQ(quality.num_samples, 20U);
  EXPECT_EQ(quality.num_planar, 0U);
  EXPECT_TRUE(std::isfinite(quality.mean_entropy.value()));
}

TEST(MapQuality, TheSameBytesForAnyNumberOfThreads) {
  const Points points = wall(60000, 0.02, 1.0, 9);
  MapQuality results[2];
  for (int threads : {1, 2}) {
    tbb::task_arena(threads).execute([&] { results[threads - 1] = map_quality(points); });
  }
  EXPECT_LT(results[0].num_samples, 25000U);
  EXPECT_GT(results[0].num_samples, 15000U);
  EXPECT_EQ(results[0].mean_entropy.value(), results[1].mean_entropy.value());
  EXPECT_EQ(results[0].plane_residual_mean_m.value(), results[1].plane_residual_mean_m.value());
  EXPECT_EQ(results[0].plane_residual_median_m.value(), results[1].plane_residual_median_m.value());
}

}  // namespace
}  // namespace mlo
