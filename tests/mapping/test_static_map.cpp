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

MapPoint at(float x, float y, float z, MapLabel label = MapLabel::surface) {
  return {.p_map = {x, y, z}, .intensity = 0.0F, .label = label};
}

TEST(StaticMap, KeepsPointsAsTheyAre) {
  MapPoint point = at(1.0F, 0.1F, 0.1F, MapLabel::edge);
  point.intensity = 0.75F;
  StaticMap map({});
  map.insert({&point, 1}, 0);
  ASSERT_EQ(map.points().size(), 1U);
  EXPECT_EQ(map.points()[0].p_map, point.p_map);
  EXPECT_EQ(map.points()[0].intensity, 0.75F);
  EXPECT_EQ(map.points()[0].label, MapLabel::edge);
}

TEST(StaticMap, KeepsOnePointPerVoxelOverAllScans) {
  std::vector<MapPoint> seen;
  for (int i = 0; i < 1000; ++i) {
    const auto k = static_cast<float>(i);
    seen.push_back(at(std::fmod(0.137F * k, 4.0F), std::fmod(0.071F * k, 3.0F), std::fmod(0.037F * k, 2.0F)));
  }
  StaticMap map({.voxel_m = 0.5});
  map.insert(seen, 0);
  const std::size_t once = map.points().size();
  map.insert(seen, 0);
  EXPECT_EQ(map.points().size(), once);
  std::set<std::tuple<int, int, int>> voxels;
  for (const MapPoint& p : seen) {
    const VoxelKey key = voxel_key(p.p_map, 2.0F);
    voxels.insert({key.x, key.y, key.z});
  }
  EXPECT_EQ(once, voxels.size());
}

TEST(StaticMap, NothingAddsNothing) {
  StaticMap map({});
  map.insert({}, 0);
  EXPECT_TRUE(map.points().empty());
}

/// Rays in a fan ahead that end on a wall across at this distance, a ray each 0.2 degrees and 16 scan lines.
std::vector<Point> wall_ahead(float distance_m) {
  std::vector<Point> points;
  for (int ring = 0; ring < 16; ++ring) {
    for (int step = -100; step <= 100; ++step) {
      Point point;
      const auto angle = static_cast<float>(step) * 0.0035F;
      point.p_lidar = {distance_m, distance_m * std::tan(angle),
                       distance_m * (0.1F - 0.02F * static_cast<float>(ring))};
      point.ring = static_cast<std::uint16_t>(ring);
      points.push_back(point);
    }
  }
  return points;
}

TEST(StaticMap, WhatLaterScansSeeThroughIsLeftOut) {
  std::vector<MapPoint> seen{at(10.0F, 0.1F, 0.1F), at(20.0F, 0.1F, 0.1F)};
  StaticMap map({.hit_votes = 1.0, .max_votes = 3.0});
  map.insert(seen, 0);
  map.observe(ScanView(wall_ahead(20.0F), SweepMotion::none(), SE3()));
  ASSERT_EQ(map.points().size(), 1U);
  EXPECT_EQ(map.points()[0].p_map.x(), 20.0F);

  // When something stands there again, for longer than it was free, it is back.
  for (int i = 0; i < 2; ++i) map.observe(ScanView(wall_ahead(10.0F), SweepMotion::none(), SE3()));
  EXPECT_EQ(map.points().size(), 2U) << "what the nearer wall hides stays";
  for (int i = 0; i < 20; ++i) map.observe(ScanView(wall_ahead(10.0F), SweepMotion::none(), SE3()));
  for (int i = 0; i < 4; ++i) map.observe(ScanView(wall_ahead(20.0F), SweepMotion::none(), SE3()));
  EXPECT_EQ(map.points().size(), 1U) << "no more than max_votes speak for it";
}

TEST(StaticMap, WhatStandsWhereTheSkyIsIsLeftOutButNotTheGround) {
  // The wall ends at the height of the lidar; nothing comes back from above.
  std::vector<Point> low_wall = wall_ahead(20.0F);
  std::erase_if(low_wall, [](const Point& point) {
    return std::abs(point.p_lidar.y()) < 3.0F && point.p_lidar.z() > 0.0F;
  });
  std::vector<MapPoint> seen{at(10.0F, 0.1F, 0.7F)};
  seen.push_back(at(9.0F, 0.1F, 0.6F, MapLabel::ground));
  StaticMap map({});
  map.insert(seen, 0);
  const ScanView view(low_wall, SweepMotion::none(), SE3());
  const ScanView hit(wall_ahead(10.0F), SweepMotion::none(), SE3());
  for (const ScanView* each : {&view, &view, &hit, &view, &view}) map.observe(*each);
  EXPECT_EQ(map.points().size(), 2U) << "now and then nothing comes back from what stands";
  map.observe(view);
  map.observe(view);
  ASSERT_EQ(map.points().size(), 1U);
  EXPECT_EQ(map.points()[0].label, MapLabel::ground);
}

TEST(StaticMap, TakesBackWhatOneScanBroughtWithinABox) {
  std::vector<MapPoint> early{at(10.0F, 0.1F, 0.1F), at(30.0F, 0.1F, 0.1F)};
  std::vector<MapPoint> late{at(10.0F, 0.5F, 0.1F)};
  StaticMap map({.moving_margin_m = 0.5});
  map.insert(early, 4);
  map.insert(late, 5);
  const SE3 T_map_object(Eigen::Quaterniond::Identity(), {11.0, 0.0, 0.0});
  const Eigen::Vector3d size(2.0, 2.0, 2.0);
  const auto x_of_points = [&] {
    std::vector<std::pair<float, float>> found;
    for (const MapPoint& point : map.points()) found.emplace_back(point.p_map.x(), point.p_map.y());
    return found;
  };
  map.take_back(3, T_map_object, size);
  EXPECT_EQ(map.points().size(), 3U) << "nothing is of that scan";
  map.take_back(4, T_map_object, size);
  EXPECT_THAT(x_of_points(), testing::UnorderedElementsAre(std::pair(30.0F, 0.1F), std::pair(10.0F, 0.5F)))
      << "of that scan, in the box";
  map.take_back(4, T_map_object, size);
  for (int i = 0; i < 20; ++i) map.observe(ScanView(wall_ahead(10.0F), SweepMotion::none(), SE3()));
  EXPECT_EQ(map.points().size(), 2U) << "no vote brings it back";

  ArchiveWriter bytes;
  StaticMap::archive(map, bytes);
  ArchiveReader reader(bytes.bytes(), "archive");
  StaticMap::archive(map, reader);
  EXPECT_EQ(map.points().size(), 2U);
  map.insert(early, 6);
  EXPECT_EQ(map.points().size(), 3U) << "a later scan fills its place anew";
}

TEST(StaticMap, WhatWaitsOnDiskIsTheSameMap) {
  std::vector<MapPoint> seen;
  for (int i = 0; i < 500; ++i) {
    seen.push_back(at(0.37F * static_cast<float>(i), 0.1F, 0.1F));
    seen.push_back(at(5.0F, 0.29F * static_cast<float>(i), 0.1F, MapLabel::edge));
  }
  StaticMap kept({.memory_radius_m = 1e6});
  StaticMap spooled({.memory_radius_m = 50.0});
  for (const float robot_m : {0.0F, 500.0F, 1000.0F, 0.0F, 20.0F}) {
    const SE3 T_map_lidar(Eigen::Quaterniond::Identity(), {static_cast<double>(robot_m), 0.0, 0.0});
    std::vector<MapPoint> placed = seen;
    for (MapPoint& point : placed) point.p_map.x() += robot_m;
    for (StaticMap* map : {&kept, &spooled}) {
      map->insert(placed, 0);
      map->observe(ScanView(wall_ahead(20.0F), SweepMotion::none(), T_map_lidar));
      map->spool_far(T_map_lidar.translation().cast<float>());
    }
    EXPECT_EQ(spooled.size(), kept.size());
  }
  const std::vector<MapPoint> expected = kept.points();
  const std::vector<MapPoint> found = spooled.points();
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_LT(found.size(), kept.size()) << "some were seen through";
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].p_map, expected[i].p_map);
    EXPECT_EQ(found[i].label, expected[i].label);
  }
}

TEST(StaticMap, WhatWasHardlySeenGoesWithItsSurroundings) {
  std::vector<MapPoint> seen;
  for (int i = 0; i < 3; ++i) seen.push_back(at(10.1F, 0.1F + 0.25F * static_cast<float>(i), 0.1F));
  seen.push_back(at(10.1F, 0.1F, 0.9F));  // above the rays, in the same cubic metre
  seen.push_back(at(10.1F, 0.1F, 2.9F));  // elsewhere
  StaticMap map({});
  map.insert(seen, 0);
  std::vector<Point> scan = wall_ahead(20.0F);
  std::erase_if(scan, [](const Point& point) { return point.p_lidar.z() > 0.06F * point.p_lidar.x(); });
  map.observe(ScanView(scan, SweepMotion::none(), SE3()));
  ASSERT_EQ(map.points().size(), 1U);
  EXPECT_EQ(map.points()[0].p_map.z(), 2.9F);
}

TEST(StaticMap, WhatLiesAboutABoxThatMovesIsNotAdded) {
  std::vector<MapPoint> seen{at(10.0F, 0.0F, 0.0F), at(12.3F, 0.0F, 0.0F), at(13.0F, 0.0F, 0.0F)};
  const Box3d car{.center_lidar_m = {10.0, 0.0, 0.0}, .size_lwh_m = {4.0, 2.0, 1.5}, .yaw_rad = 0.0};
  StaticMap map({.moving_margin_m = 0.5});
  for (MapPoint& point : seen) point.p_map.x() += 100.0F;
  const SE3 T_map_lidar(Eigen::Quaterniond::Identity(), {100.0, 0.0, 0.0});
  map.insert(seen, 0, {.T_map_lidar = T_map_lidar, .moving = {car}});
  ASSERT_EQ(map.points().size(), 1U);
  EXPECT_EQ(map.points()[0].p_map.x(), 113.0F);
}

TEST(StaticMap, OfColumnsOnlyTheGroundIsAdded) {
  const std::vector<MapPoint> seen{at(10.0F, 0.1F, 0.1F), at(10.0F, 0.1F, -1.6F, MapLabel::ground),
                                   at(15.0F, 0.1F, 0.1F)};
  ColumnSet columns(0.5);
  columns.insert(columns.key_of(seen[0].p_map));
  StaticMap map({});
  map.insert(seen, 0, {.T_map_lidar = SE3(), .columns = columns});
  std::vector<std::pair<float, MapLabel>> found;  // the order is the map's own
  for (const MapPoint& point : map.points()) found.emplace_back(point.p_map.x(), point.label);
  EXPECT_THAT(found, testing::UnorderedElementsAre(std::pair(10.0F, MapLabel::ground),
                                                   std::pair(15.0F, MapLabel::surface)));
}

TEST(StaticMap, WhatIsOutOfReachIsNotVotedOn) {
  std::vector<MapPoint> seen{at(10.0F, 0.1F, 0.1F)};
  StaticMap map({}, {.range_m = 5.0});
  map.insert(seen, 0);
  for (int i = 0; i < 5; ++i) map.observe(ScanView(wall_ahead(20.0F), SweepMotion::none(), SE3()));
  EXPECT_EQ(map.points().size(), 1U);
}

TEST(StaticMap, LooksFromWhereTheLidarWasAtThatTimeOfTheSweep) {
  // The lidar turned by a tenth of a radian in the sweep; the point was seen at its end, straight ahead.
  const SweepMotion motion(SE3(so3_exp({0.0, 0.0, 0.1}), Eigen::Vector3d::Zero()), 0.5);
  MapPoint late = at(0.0F, 0.0F, 0.0F);
  late.p_map = motion.undistort({10.0, 0.0, 0.1}, 1.0).cast<float>();
  std::vector<Point> scan = wall_ahead(20.0F);
  for (Point& point : scan) {
    point.sweep_fraction = 1.0F;
    // Where the point lies at the reference time something near hides it.
    if (point.p_lidar.y() > 0.5F) point.p_lidar *= 0.25F;
  }
  StaticMap map({});
  map.insert({&late, 1}, 0);
  map.observe(ScanView(scan, motion, SE3()));
  EXPECT_TRUE(map.points().empty());
}

}  // namespace
}  // namespace mlo
