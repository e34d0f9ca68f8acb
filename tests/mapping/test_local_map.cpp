#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "mlo/mapping/local_map.hpp"

namespace mlo {
namespace {

using Points = std::vector<Eigen::Vector3f>;

// The map keeps points to 1/65536 of a voxel, 15 micrometres for the largest voxels here.
constexpr float kResolutionM = 2e-5F;
constexpr float kResolutionM2 =
    2.0F * 1.8F * kResolutionM;  // of squared distances to neighbours in 27 voxels

void expect_point(const Eigen::Vector3f& found, const Eigen::Vector3f& expected) {
  EXPECT_LT((found - expected).norm(), kResolutionM)
      << found.transpose() << " is not " << expected.transpose();
}

Points random_points(std::size_t count, float half_side_m) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-half_side_m, half_side_m);
  Points points(count);
  for (Eigen::Vector3f& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

/// What a map with this configuration keeps: the rules of insert() by plain lists.
class PlainMap {
 public:
  explicit PlainMap(const LocalMapConfig& config) : config_(config) {}

  void insert(const Points& points) {
    for (const Eigen::Vector3f& p : points) {
      Points& voxel = voxels_[key(p)];
      const bool crowded = std::any_of(voxel.begin(), voxel.end(), [&](const Eigen::Vector3f& q) {
        return (p - q).norm() < static_cast<float>(config_.min_spacing_m);
      });
      if (!crowded && voxel.size() < static_cast<std::size_t>(config_.max_points_per_voxel))
        voxel.push_back(p);
    }
  }

  /// Ascending squared distances of the points in the 27 voxels around the query.
  std::vector<float> squared_distances(const Eigen::Vector3f& query) const {
    std::vector<float> result;
    const auto [x, y, z] = key(query);
    for (const auto& [other, points] : voxels_) {
      const auto [ox, oy, oz] = other;
      if (std::max({std::abs(ox - x), std::abs(oy - y), std::abs(oz - z)}) > 1) continue;
      for (const Eigen::Vector3f& p : points) result.push_back((p - query).squaredNorm());
    }
    std::sort(result.begin(), result.end());
    return result;
  }

  std::size_t num_voxels() const { return voxels_.size(); }

 private:
  using Key = std::tuple<int, int, int>;
  Key key(const Eigen::Vector3f& p) const {
    const auto side = static_cast<float>(config_.voxel_m);
    const auto index = [&](float value) { return static_cast<int>(std::floor(value / side)); };
    return {index(p.x()), index(p.y()), index(p.z())};
  }

  LocalMapConfig config_;
  std::map<Key, Points> voxels_;
};

void expect_same_neighbours(const LocalMap& map, const PlainMap& plain, int k) {
  for (const Eigen::Vector3f& query : random_points(300, 3.5F)) {
    const std::vector<float> expected = plain.squared_distances(query);
    const NearestPoints found = map.nearest(query, k, 100.0F);
    ASSERT_EQ(static_cast<std::size_t>(found.count), std::min(static_cast<std::size_t>(k), expected.size()));
    for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
      EXPECT_NEAR(found.squared_distances_m2[i], expected[i], kResolutionM2 + expected[i] / 8000.0F);
      EXPECT_NEAR((found.points[i] - query).squaredNorm(), found.squared_distances_m2[i], kResolutionM2);
    }
  }
}

TEST(LocalMap, NearestAreThoseOfBruteForceOverTheVoxelsAround) {
  const LocalMapConfig config;
  const Points points = random_points(8000, 3.0F);
  LocalMap map(config);
  PlainMap plain(config);
  map.insert(points);
  plain.insert(points);
  EXPECT_EQ(map.num_voxels(), plain.num_voxels());
  expect_same_neighbours(map, plain, 8);
  expect_same_neighbours(map, plain, 1);
  expect_same_neighbours(map, plain, 5);
}

TEST(LocalMap, NearestInASparseMapAreThoseOfBruteForce) {
  const LocalMapConfig config;
  const Points points = random_points(300, 3.0F);
  LocalMap map(config);
  PlainMap plain(config);
  map.insert(points);
  plain.insert(points);
  expect_same_neighbours(map, plain, 8);
}

TEST(LocalMap, NothingIsFoundWhenTheNearestIsBeyondTheGate) {
  LocalMap map({.voxel_m = 1.0});
  map.insert(Points{{0.5F, 0.5F, 0.5F}, {0.9F, 0.5F, 0.5F}});
  EXPECT_EQ(map.nearest({0.5F, 0.5F, 0.7F}, 5, 0.1F).count, 0);
  EXPECT_EQ(map.nearest({0.5F, 0.5F, 0.7F}, 5, 0.3F).count, 2);
}

TEST(LocalMap, PointsNearerThanTheSpacingAreLeftOut) {
  LocalMap map({.voxel_m = 1.0, .min_spacing_m = 0.2});
  map.insert(Points{{0.1F, 0.1F, 0.1F}, {0.25F, 0.1F, 0.1F}, {0.35F, 0.1F, 0.1F}});
  const NearestPoints found = map.nearest({0.0F, 0.1F, 0.1F}, 5, 10.0F);
  ASSERT_EQ(found.count, 2);
  expect_point(found.points[0], Eigen::Vector3f(0.1F, 0.1F, 0.1F));
  expect_point(found.points[1], Eigen::Vector3f(0.35F, 0.1F, 0.1F));
}

TEST(LocalMap, AVoxelHoldsNoMoreThanItsCapacity) {
  LocalMap map({.voxel_m = 1.0, .max_points_per_voxel = 3, .min_spacing_m = 0.0});
  map.insert(Points(50, Eigen::Vector3f(0.5F, 0.5F, 0.5F)));
  EXPECT_EQ(map.nearest({0.5F, 0.5F, 0.5F}, 8, 1.0F).count, 3);
}

TEST(LocalMap, WhatIsFarFromTheRobotIsForgottenWhileItDrives) {
  LocalMap map({.voxel_m = 1.0, .radius_m = 10.0});
  std::size_t most = 0;
  for (int i = 0; i < 500; ++i) {
    const auto x = static_cast<float>(i);
    map.insert(Points{{x, 0.5F, 0.5F}, {x, 3.5F, 0.5F}, {x, -3.5F, 0.5F}});
    map.forget_beyond_radius({x, 0.0F, 0.0F});
    most = std::max(most, map.num_voxels());
  }
  EXPECT_LE(most, 3U * 11U);
  EXPECT_EQ(map.nearest({100.0F, 0.5F, 0.5F}, 5, 1.0F).count, 0);
  // The voxel whose storage was used before holds only its own points.
  const NearestPoints found = map.nearest({499.0F, 0.5F, 0.5F}, 8, 1.0F);
  ASSERT_EQ(found.count, 2);
  expect_point(found.points[0], Eigen::Vector3f(499.0F, 0.5F, 0.5F));
  expect_point(found.points[1], Eigen::Vector3f(498.0F, 0.5F, 0.5F));
}

TEST(LocalMap, EmptyAndClearedMapsFindNothing) {
  LocalMap map({});
  EXPECT_TRUE(map.empty());
  EXPECT_EQ(map.nearest({0.0F, 0.0F, 0.0F}, 8, 10.0F).count, 0);
  map.forget_beyond_radius({0.0F, 0.0F, 0.0F});
  map.insert(Points{{0.1F, 0.1F, 0.1F}});
  EXPECT_FALSE(map.empty());
  map.clear();
  EXPECT_TRUE(map.empty());
  EXPECT_EQ(map.nearest({0.1F, 0.1F, 0.1F}, 8, 10.0F).count, 0);
  map.insert(Points{{0.2F, 0.1F, 0.1F}});
  EXPECT_EQ(map.nearest({0.1F, 0.1F, 0.1F}, 8, 10.0F).count, 1);
}

}  // namespace
}  // namespace mlo
