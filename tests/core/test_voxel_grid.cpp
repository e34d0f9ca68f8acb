#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "mlo/core/voxel_grid.hpp"

namespace mlo {
namespace {

const auto kItself = [](const Eigen::Vector3f& p) { return p; };

std::vector<Eigen::Vector3f> grid_of_points(int points_per_side, float spacing) {
  std::vector<Eigen::Vector3f> points;
  for (int x = 0; x < points_per_side; ++x) {
    for (int y = 0; y < points_per_side; ++y) {
      for (int z = 0; z < points_per_side; ++z) {
        points.emplace_back(spacing * (Eigen::Array3f(x, y, z) - 0.5F * points_per_side + 0.25F));
      }
    }
  }
  return points;
}

TEST(VoxelGrid, KeysRoundDownOnBothSidesOfZero) {
  EXPECT_EQ(voxel_key({0.1F, -0.1F, 0.6F}, 2.0F), (VoxelKey{0, -1, 1}));
  EXPECT_EQ(voxel_key({0.5F, -0.5F, -0.6F}, 2.0F), (VoxelKey{1, -1, -2}));
}

TEST(VoxelGrid, NeighbouringKeysRarelyShareTheLowBitsOfTheirHash) {
  std::set<std::size_t> buckets;
  for (int x = -8; x < 8; ++x) {
    for (int y = -8; y < 8; ++y) {
      for (int z = -2; z < 2; ++z) buckets.insert(VoxelKeyHash{}({x, y, z}) & 0xFFFU);
    }
  }
  EXPECT_GT(buckets.size(), 800U);  // 1024 keys in 4096 buckets; chance alone fills 906
}

TEST(VoxelGrid, KeepsTheFirstPointOfEachVoxelInOrder) {
  const std::vector<Eigen::Vector3f> points = grid_of_points(12, 0.25F);
  std::vector<Eigen::Vector3f> expected;
  std::set<std::tuple<int, int, int>> seen;
  for (const Eigen::Vector3f& p : points) {
    const VoxelKey key = voxel_key(p, 1.0F / 0.6F);
    if (seen.insert({key.x, key.y, key.z}).second) expected.push_back(p);
  }
  EXPECT_EQ(downsample_first(std::span<const Eigen::Vector3f>(points), 0.6F, kItself), expected);
  EXPECT_LT(expected.size(), points.size() / 4);
}

TEST(VoxelGrid, NothingAndOnePoint) {
  EXPECT_TRUE(downsample_first(std::span<const Eigen::Vector3f>(), 0.2F, kItself).empty());
  const std::vector<Eigen::Vector3f> one{{1.0F, 2.0F, 3.0F}};
  EXPECT_EQ(downsample_first(std::span<const Eigen::Vector3f>(one), 0.2F, kItself), one);
}

}  // namespace
}  // namespace mlo
