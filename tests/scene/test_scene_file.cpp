#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file_bytes.hpp"
#include "mlo/scene/scene_file.hpp"
#include "scene/small_scene.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

void expect_scan(const SceneScan& scan, const SceneScan& expected) {
  EXPECT_EQ(scan.frame, expected.frame);
  EXPECT_EQ(scan.stamp_s, expected.stamp_s);
  EXPECT_EQ(scan.status, expected.status);
  EXPECT_EQ(scan.problem, expected.problem);
  EXPECT_EQ(scan.T_map_lidar.matrix(), expected.T_map_lidar.matrix());
  EXPECT_EQ(scan.covariance, expected.covariance);
  ASSERT_EQ(scan.objects.size(), expected.objects.size());
  for (std::size_t i = 0; i < scan.objects.size(); ++i) {
    EXPECT_EQ(scan.objects[i].id, expected.objects[i].id);
    EXPECT_EQ(scan.objects[i].object_class, expected.objects[i].object_class);
    EXPECT_EQ(scan.objects[i].T_map_object.matrix(), expected.objects[i].T_map_object.matrix());
    EXPECT_EQ(scan.objects[i].velocity_map_mps, expected.objects[i].velocity_map_mps);
  }
}

TEST(SceneFile, EverythingComesBack) {
  const test::TempFolder folder;
  test::write_small_scene(folder.path() / "scene.mlo", 4);
  const SceneFile scene(folder.path() / "scene.mlo");
  EXPECT_TRUE(scene.complete());
  EXPECT_EQ(scene.meta().program_version, "1.2");
  EXPECT_EQ(scene.meta().configuration, "a: 1\n");
  ASSERT_EQ(scene.num_scans(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    expect_scan(scene.scan(i), test::small_scan(i));
    const SceneCloud cloud = scene.cloud(i);
    EXPECT_EQ(cloud.groups, test::small_cloud(i).groups);
    EXPECT_LT((cloud.points[5].p - test::small_cloud(i).points[5].p).norm(), 0.004F);
  }
  const std::vector<MapPoint> map = scene.map();
  ASSERT_EQ(map.size(), test::small_map().size());
  std::size_t ground = 0;
  for (const MapPoint& point : map) {
    EXPECT_NEAR(point.p_map.y(), 3.0F, 1e-3F);
    ground += point.label == MapLabel::ground ? 1U : 0U;
  }
  EXPECT_EQ(ground, 50U);
}

TEST(SceneFile, WithoutAnEndItHasAllScansThatWereWritten) {
  const test::TempFolder folder;
  test::write_small_scene(folder.path() / "scene.mlo", 3, false);
  const SceneFile scene(folder.path() / "scene.mlo");
  EXPECT_FALSE(scene.complete());
  ASSERT_EQ(scene.num_scans(), 3U);
  expect_scan(scene.scan(2), test::small_scan(2));
  EXPECT_EQ(scene.cloud(2).points.size(), test::small_cloud(2).points.size());
  EXPECT_TRUE(scene.map().empty());
}

TEST(SceneFile, WithoutScansItIsEmpty) {
  const test::TempFolder folder;
  test::write_small_scene(folder.path() / "scene.mlo", 0, false);
  EXPECT_EQ(SceneFile(folder.path() / "scene.mlo").num_scans(), 0U);
}

TEST(SceneFile, TheLastMapCounts) {
  const test::TempFolder folder;
  const std::filesystem::path path = folder.path() / "scene.mlo";
  std::vector<MapPoint> points = test::small_map();
  {
    SceneWriter writer(path, SceneMeta(), {});
    writer.write_map(points);
    points.erase(points.begin(), points.begin() + 60);  // whole tiles vanish
    points.push_back({{1.0F, 2.0F, 50.0F}, 0.0F, MapLabel::edge});
    writer.write_map(points);
    writer.write_map(points);
    writer.finish();
  }
  const SceneFile scene(path);
  EXPECT_EQ(scene.map().size(), points.size());
  for (const MapPoint& point : scene.map()) EXPECT_GT(point.p_map.x(), 0.5F);
}

TEST(SceneFile, AMapThatStaysIsNotWrittenAgain) {
  const test::TempFolder folder;
  {
    SceneWriter writer(folder.path() / "scene.mlo", SceneMeta(), {});
    for (int i = 0; i < 3; ++i) writer.write_map(test::small_map());
  }
  const ChunkFile file(folder.path() / "scene.mlo");
  EXPECT_EQ(file.chunks().size(), 1U + 4U);  // meta, and the tiles that 70 m of points lie in
}

TEST(SceneFile, TheSameSceneHasTheSameBytes) {
  const test::TempFolder folder;
  test::write_small_scene(folder.path() / "a.mlo", 3);
  test::write_small_scene(folder.path() / "b.mlo", 3);
  EXPECT_EQ(test::read_bytes(folder.path() / "a.mlo"), test::read_bytes(folder.path() / "b.mlo"));
}

TEST(SceneFile, RobotPosesHaveFramesAndStamps) {
  const test::TempFolder folder;
  test::write_small_scene(folder.path() / "scene.mlo", 3);
  const PoseList poses = robot_poses(SceneFile(folder.path() / "scene.mlo"));
  EXPECT_THAT(poses.frames, testing::ElementsAre(10, 11, 12));
  EXPECT_EQ(poses.stamps_s.at(2), test::small_scan(2).stamp_s);
  EXPECT_EQ(poses.T_world_body.at(2).matrix(), test::small_scan(2).T_map_lidar.matrix());
}

}  // namespace
}  // namespace mlo
