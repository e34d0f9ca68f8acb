#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/pipeline/pipeline.hpp"
#include "mlo/pipeline/start_in_map.hpp"
#include "mlo/scene/scene_writer.hpp"
#include "pipeline/street.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<MapPoint> street_map() {
  Pipeline pipeline(test::street_config());
  for (std::size_t i = 0; i < 20; ++i)
    pipeline.process(test::street_scan(i, static_cast<double>(i), false), {});
  return pipeline.static_map().points();
}

SE3 pose_on_street(double sweeps) {
  return test::street_pose(0.0).inverse() * test::street_pose(sweeps);
}

/// Localises from the fourth scan on, started beside where it was; returns how many scans it took to find the
/// place.
std::size_t scans_to_find(Pipeline& pipeline) {
  std::size_t to_find = 0;
  for (std::size_t i = 4; i < 14; ++i) {
    const FrameResult result = pipeline.process(test::street_scan(i, static_cast<double>(i), false), {});
    EXPECT_FALSE(result.first);
    if (!result.localised()) ++to_find;
    if (i < 8) continue;  // by then the motion is known
    const SE3 error = pose_on_street(static_cast<double>(i)).inverse() * result.T_map_lidar;
    EXPECT_LT(error.translation().norm(), 0.1) << i;
    EXPECT_LT(error.rotation_angle_rad(), 0.5 * kDegree) << i;
  }
  return to_find;
}

TEST(SavedMap, ThePlaceIsFoundFromAStartNearby) {
  const std::vector<MapPoint> map = street_map();
  for (const auto& [x_m, y_m, yaw_deg] : {std::array{0.0, 0.0, 0.0}, {3.0, -2.0, 10.0}, {-4.0, 1.5, -14.0}}) {
    const SE3 error(so3_exp({0.0, 0.0, yaw_deg * kDegree}), {x_m, y_m, 0.0});
    Pipeline pipeline(test::street_config(), map, pose_on_street(4.0) * error);
    EXPECT_LT(scans_to_find(pipeline), 3U) << x_m;
    EXPECT_EQ(pipeline.static_map().size(), 0U);  // the map stays as it was
  }
}

TEST(SavedMap, ElsewhereNothingIsFound) {
  std::vector<MapPoint> map = street_map();
  for (MapPoint& point : map) point.p_map.x() += 500.0F;
  Pipeline pipeline(test::street_config(), map, SE3());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_FALSE(pipeline.process(test::street_scan(i, static_cast<double>(i), false), {}).localised());
  }
}

TEST(SavedMap, APipelineWithAMapGoesOnFromItsState) {
  const std::vector<MapPoint> map = street_map();
  Pipeline pipeline(test::street_config(), map, pose_on_street(4.0));
  for (std::size_t i = 4; i < 7; ++i)
    pipeline.process(test::street_scan(i, static_cast<double>(i), false), {});
  ArchiveWriter state;
  state(pipeline);
  Pipeline other(test::street_config(), map, pose_on_street(4.0));
  ArchiveReader(state.bytes(), "state")(other);
  for (std::size_t i = 7; i < 10; ++i) {
    const Scan scan = test::street_scan(i, static_cast<double>(i), false);
    EXPECT_EQ(other.process(scan, {}).T_map_lidar.matrix(), pipeline.process(scan, {}).T_map_lidar.matrix());
  }
}

TEST(StartInMap, FromASceneOrAMapFile) {
  const test::TempFolder folder;
  const std::vector<MapPoint> points{{{1.0F, 2.0F, 3.0F}, 0.5F, MapLabel::ground}};
  write_ply(folder.path() / "map.ply", points);
  {
    SceneWriter writer(folder.path() / "scene.mlo", SceneMeta(), {});
    SceneScan scan;
    for (const double x_m : {5.0, 10.0}) {
      scan.T_map_lidar = SE3(so3_exp({0.0, 0.0, 30.0 * kDegree}), {x_m, 0.0, 0.1 * x_m});
      writer.write(scan, nullptr);
    }
    writer.write_map(points);
    writer.finish();
  }
  EXPECT_EQ(start_in_map(folder.path() / "map.ply", {}).points.size(), 1U);
  EXPECT_EQ(start_in_map(folder.path() / "map.ply", {}).T_map_lidar.translation().norm(), 0.0);
  const StartInMap first = start_in_map(folder.path() / "scene.mlo", {});
  EXPECT_EQ(first.points.size(), 1U);
  EXPECT_EQ(first.T_map_lidar.translation().x(), 5.0);
  const SE3 chosen =
      start_in_map(folder.path() / "scene.mlo", Eigen::Vector4d(11.0, 2.0, 1.0, 90.0)).T_map_lidar;
  EXPECT_TRUE(chosen.translation().isApprox(Eigen::Vector3d(11.0, 2.0, 1.0)));
  EXPECT_TRUE((chosen.rotation() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
}

TEST(StartInMap, WithoutAMapItIsAnInputError) {
  const test::TempFolder folder;
  write_ply(folder.path() / "map.ply", {});
  EXPECT_THROW(start_in_map(folder.path() / "map.ply", {}), InputError);
  EXPECT_THROW(start_in_map(folder.path() / "absent.mlo", {}), InputError);
}

}  // namespace
}  // namespace mlo
