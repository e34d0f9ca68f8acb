#include <cmath>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/mapping/static_map.hpp"

namespace mlo {
namespace {

FeaturePoint at(float x, float y, float z) {
  FeaturePoint point;
  point.p_lidar = {x, y, z};
  point.sweep_fraction = 0.5F;
  return point;
}

TEST(StaticMap, LabelsPointsAndLeavesObjectsOut) {
  Percept seen;
  seen.edge.candidates = {at(1.0F, 0.1F, 0.1F)};
  seen.ground.candidates = {at(2.0F, 0.1F, 0.1F)};
  seen.surface.candidates = {at(3.0F, 0.1F, 0.1F)};
  seen.surface.features = {at(4.0F, 0.1F, 0.1F)};
  Point object_point;
  object_point.p_lidar = {5.0F, 0.0F, 0.0F};
  seen.objects.push_back({{}, {object_point}, {at(6.0F, 0.1F, 0.1F)}});
  StaticMap map({});
  map.insert(seen, SweepMotion::none(), SE3());
  std::vector<std::pair<float, MapLabel>> found;  // the order is the map's own
  for (const MapPoint& point : map.points()) found.emplace_back(point.p_map.x(), point.label);
  EXPECT_THAT(found, testing::UnorderedElementsAre(std::pair(1.0F, MapLabel::edge), std::pair(2.0F, MapLabel::ground),
                                                   std::pair(3.0F, MapLabel::surface)));
}

TEST(StaticMap, KeepsOnePointPerVoxelOverAllScans) {
  Percept seen;
  for (int i = 0; i < 1000; ++i) {
    const auto k = static_cast<float>(i);
    seen.surface.candidates.push_back(
        at(std::fmod(0.137F * k, 4.0F), std::fmod(0.071F * k, 3.0F), std::fmod(0.037F * k, 2.0F)));
  }
  StaticMap map({.voxel_m = 0.5});
  map.insert(seen, SweepMotion::none(), SE3());
  const std::size_t once = map.points().size();
  map.insert(seen, SweepMotion::none(), SE3());
  EXPECT_EQ(map.points().size(), once);
  std::set<std::tuple<int, int, int>> voxels;
  for (const FeaturePoint& p : seen.surface.candidates) {
    const VoxelKey key = voxel_key(p.p_lidar, 2.0F);
    voxels.insert({key.x, key.y, key.z});
  }
  EXPECT_EQ(once, voxels.size());
}

TEST(StaticMap, PlacesPointsByTheirTimeAndThePose) {
  Percept seen;
  FeaturePoint early = at(10.0F, 0.0F, 0.0F);
  early.sweep_fraction = 0.0F;
  early.intensity = 0.75F;
  seen.edge.candidates = {early};
  StaticMap map({});
  const SweepMotion motion(SE3(Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}), 0.5);
  map.insert(seen, motion, SE3(Eigen::Quaterniond::Identity(), {0.0, 7.0, 0.0}));
  ASSERT_EQ(map.points().size(), 1U);
  // At its start the sweep was half a metre behind where it was at its middle.
  EXPECT_LT((map.points()[0].p_map - Eigen::Vector3f(9.5F, 7.0F, 0.0F)).norm(), 1e-5F);
  EXPECT_EQ(map.points()[0].intensity, 0.75F);
}

TEST(StaticMap, AnEmptyPerceptAddsNothing) {
  StaticMap map({});
  map.insert(Percept{}, SweepMotion::none(), SE3());
  EXPECT_TRUE(map.points().empty());
}

}  // namespace
}  // namespace mlo
