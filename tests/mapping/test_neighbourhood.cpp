#include <cmath>

#include <gtest/gtest.h>

#include "mlo/mapping/neighbourhood.hpp"

namespace mlo {
namespace {

NearestPoints neighbours(const std::vector<Eigen::Vector3f>& points) {
  NearestPoints result;
  for (const Eigen::Vector3f& p : points) result.points[static_cast<std::size_t>(result.count++)] = p;
  return result;
}

/// On the plane z = 0.1 x + 2.
NearestPoints plane() {
  std::vector<Eigen::Vector3f> points;
  for (const float x : {0.0F, 0.2F, 0.4F, 0.6F}) {
    for (const float y : {0.0F, 0.5F}) points.emplace_back(x, y, 0.1F * x + 2.0F);
  }
  return neighbours(points);
}

/// Along z at (1, 2), a little scattered.
NearestPoints post() {
  return neighbours({{1.0F, 2.01F, 0.0F},
                     {1.01F, 2.0F, 0.3F},
                     {1.0F, 1.99F, 0.6F},
                     {0.99F, 2.0F, 0.9F},
                     {1.0F, 2.0F, 1.2F},
                     {1.005F, 2.005F, 1.5F}});
}

/// The corners of a cube of 0.8 m around (0, 0, 0).
NearestPoints blob() {
  std::vector<Eigen::Vector3f> points;
  for (const float x : {-0.4F, 0.4F}) {
    for (const float y : {-0.4F, 0.4F}) {
      for (const float z : {-0.4F, 0.4F}) points.emplace_back(x, y, z);
    }
  }
  return neighbours(points);
}

RefinementConfig model(ShapeModel shape_model) {
  RefinementConfig config;
  config.shape_model = shape_model;
  return config;
}
const RefinementConfig kLoam = model(ShapeModel::loam);
const RefinementConfig kDistribution = model(ShapeModel::distribution);

TEST(Describe, APlaneHoldsItsNormalOnly) {
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.1, 0.0, 1.0).normalized();
  for (const RefinementConfig& config : {kLoam, kDistribution}) {
    const ShapeMatch match = describe(plane(), ExpectedShape::plane, config);
    ASSERT_EQ(match.num_directions, 1);
    EXPECT_NEAR(std::abs(match.directions[0].cast<double>().dot(normal)), 1.0, 1e-5);
    EXPECT_EQ(match.weights[0], 1.0F);
    const Eigen::Vector3d off_plane = Eigen::Vector3d(5.0, -3.0, 2.5) + 0.4 * normal;
    EXPECT_NEAR(match.squared_distance_m2(off_plane), 0.16, 1e-3);
  }
}

TEST(Describe, AnEdgePointMatchesALineAcrossIt) {
  const ShapeMatch match = describe(post(), ExpectedShape::line, kLoam);
  ASSERT_EQ(match.num_directions, 2);
  const Eigen::Vector3d beside = match.q_map.cast<double>() + Eigen::Vector3d(0.3, 0.4, 0.0);
  EXPECT_NEAR(match.squared_distance_m2(beside), 0.25, 0.01);
  const Eigen::Vector3d above = match.q_map.cast<double>() + Eigen::Vector3d(0.0, 0.0, 1.0);
  EXPECT_NEAR(match.squared_distance_m2(above), 0.0, 1e-3);
}

TEST(Describe, LoamTakesNothingButWhatItExpects) {
  EXPECT_EQ(describe(plane(), ExpectedShape::line, kLoam).num_directions, 0);
  EXPECT_EQ(describe(blob(), ExpectedShape::plane, kLoam).num_directions, 0);
  EXPECT_EQ(describe(blob(), ExpectedShape::line, kLoam).num_directions, 0);
}

TEST(Describe, ADistributionHoldsByNoiseOverSpread) {
  const ShapeMatch match = describe(blob(), ExpectedShape::plane, kDistribution);
  ASSERT_EQ(match.num_directions, 3);
  const double noise2 = kDistribution.noise_m * kDistribution.noise_m;
  const double weight = noise2 / (noise2 + 0.16);  // all variances are 0.4^2
  for (const float w : match.weights) EXPECT_NEAR(static_cast<double>(w), weight, 1e-6);
  EXPECT_NEAR(match.squared_distance_m2({0.1, -0.2, 0.2}), weight * 0.09, 1e-6);
}

TEST(Describe, AThickNeighbourhoodIsNoPlane) {
  RefinementConfig config = kLoam;
  config.max_thickness_m = 0.001;
  NearestPoints rough = plane();
  rough.points[4].z() += 0.02F;
  EXPECT_EQ(describe(rough, ExpectedShape::plane, config).num_directions, 0);
  EXPECT_EQ(describe(rough, ExpectedShape::plane, kLoam).num_directions, 1);
}

TEST(Describe, FewerThanFiveNeighboursMatchNothing) {
  for (int count = 0; count < 5; ++count) {
    NearestPoints few = plane();
    few.count = count;
    EXPECT_EQ(describe(few, ExpectedShape::plane, kDistribution).num_directions, 0);
    EXPECT_EQ(describe(few, ExpectedShape::plane, kLoam).num_directions, 0);
  }
}

TEST(Describe, CollinearAndEqualPointsGiveFiniteMatches) {
  const NearestPoints equal = neighbours(std::vector<Eigen::Vector3f>(6, Eigen::Vector3f(3.0F, 4.0F, 5.0F)));
  std::vector<Eigen::Vector3f> along;
  for (int i = 0; i < 6; ++i) along.emplace_back(100.0F + 0.1F * static_cast<float>(i), 50.0F, 1.0F);
  for (const NearestPoints& points : {equal, neighbours(along)}) {
    for (const RefinementConfig& config : {kLoam, kDistribution}) {
      for (const ExpectedShape expected : {ExpectedShape::plane, ExpectedShape::line}) {
        const ShapeMatch match = describe(points, expected, config);
        for (std::size_t i = 0; i < static_cast<std::size_t>(match.num_directions); ++i) {
          EXPECT_TRUE(match.directions[i].allFinite());
          EXPECT_NEAR(match.directions[i].norm(), 1.0F, 1e-4F);
        }
        EXPECT_TRUE(std::isfinite(match.squared_distance_m2({1.0, 2.0, 3.0})));
      }
    }
  }
}

}  // namespace
}  // namespace mlo
