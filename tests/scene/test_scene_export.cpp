#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/scene/foxglove.hpp"
#include "mlo/scene/scene_export.hpp"
#include "scene/small_scene.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

class Export : public testing::Test {
 protected:
  Export() { test::write_small_scene(folder_.path() / "scene.mlo", 4); }
  SceneFile scene() const { return SceneFile(folder_.path() / "scene.mlo"); }

  test::TempFolder folder_;
};

TEST_F(Export, ObjectsHaveARowForEachScan) {
  const std::vector<ObjectPose> rows = object_poses(scene());
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[2].frame, 12U);
  EXPECT_EQ(rows[2].type, "van");
  EXPECT_EQ(rows[2].state, "moving");
  EXPECT_EQ(rows[2].T_map_object.translation().x(), 1.0);
}

TEST_F(Export, AnObjectsTrajectory) {
  const PoseList poses = object_trajectory(scene(), 3);
  ASSERT_EQ(poses.T_world_body.size(), 4U);
  EXPECT_EQ(poses.T_world_body[3].translation().x(), 1.5);
  EXPECT_THROW(object_trajectory(scene(), 4), InputError);
}

TEST_F(Export, AnObjectsCloudIsItsShape) {
  const std::vector<MapPoint> points = object_cloud(scene(), 3, 0.05);
  const SceneCloud shape = test::small_shape();
  ASSERT_EQ(points.size(), shape.points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((points[i].p_map - shape.points[i].p).norm(), 0.001F);
    EXPECT_EQ(points[i].label, MapLabel::object);
  }
  EXPECT_EQ(object_cloud(scene(), 3, 10.0).size(), 1U);
}

// The same point of the object would be one voxel; here the robot drives past a point fixed in its own frame.
TEST_F(Export, WithoutAShapeAnObjectsCloudIsWhatTheScansSaw) {
  test::write_small_scene(folder_.path() / "scene.mlo", 4, false);
  const std::vector<MapPoint> points = object_cloud(scene(), 3, 0.05);
  ASSERT_EQ(points.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const SceneScan scan = test::small_scan(i);
    const Eigen::Vector3d expected =
        scan.objects[0].T_map_object.inverse() * (scan.T_map_lidar * Eigen::Vector3d(3.0, 4.0, -0.5));
    EXPECT_LT((points[i].p_map.cast<double>() - expected).norm(), 0.005);
  }
  EXPECT_THROW(object_cloud(scene(), 4, 0.05), InputError);
}

TEST(Foxglove, StampsAreNanoseconds) {
  EXPECT_EQ(foxglove::to_ns(1.25), 1'250'000'000U);
  EXPECT_EQ(foxglove::to_ns(-1.0), 0U);  // the format has none before zero
}

}  // namespace
}  // namespace mlo
