#include <fstream>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file_bytes.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/pipeline/move_results.hpp"
#include "mlo/pipeline/object_table.hpp"
#include "mlo/scene/scene_file.hpp"
#include "scene/small_scene.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

constexpr std::size_t kMovedScans = 4;

class MoveResults : public testing::Test {
 protected:
  MoveResults() {
    const std::filesystem::path& folder = folder_.path();
    test::write_small_scene(folder / "scene.mlo", kMovedScans);
    std::ofstream table(folder / "objects.csv");
    table << object_table_header() << '\n';
    for (std::size_t i = 0; i < kMovedScans; ++i) {
      const SceneScan scan = test::small_scan(i);
      TrackedObject object;
      object.id = 3;
      object.moving = true;
      object.T_map_object = scan.objects[0].T_map_object;
      object.velocity_map_mps = scan.objects[0].velocity_map_mps;
      object.hits = 7;
      table << object_table_row({scan.frame, scan.stamp_s}, object) << '\n';
    }
  }

  void move_by(const SE3& correction) const {
    const std::vector<SE3> corrections(kMovedScans, correction);
    move_results(folder_.path(), corrections, map_, SE3(), {});
  }

  test::TempFolder folder_;
  std::vector<MapPoint> map_{{{1.0F, 2.0F, 3.0F}, 0.5F, MapLabel::edge}};
};

TEST_F(MoveResults, SceneAndFilesTellTheSame) {
  const SE3 correction(so3_exp({0.0, 0.0, 0.5 * std::numbers::pi}), {10.0, 0.0, 1.0});
  move_by(correction);
  const SceneFile scene(folder_.path() / "scene.mlo");
  const PoseList robot = read_trajectory(folder_.path() / "trajectory.txt");
  const PoseList stamped = read_trajectory(folder_.path() / "trajectory_tum.txt");
  const PoseList car = read_trajectory(folder_.path() / "object_trajectories" / "00003.txt");
  const std::vector<ObjectPose> rows = read_objects_csv(folder_.path() / "objects.csv");
  ASSERT_EQ(scene.num_scans(), kMovedScans);
  ASSERT_EQ(rows.size(), kMovedScans);
  for (std::size_t i = 0; i < kMovedScans; ++i) {
    const SceneScan before = test::small_scan(i);
    const SE3 robot_pose = correction * before.T_map_lidar;
    const SE3 car_pose = correction * before.objects[0].T_map_object;
    EXPECT_TRUE(scene.scan(i).T_map_lidar.matrix().isApprox(robot_pose.matrix()));
    EXPECT_TRUE(robot.T_world_body.at(i).matrix().isApprox(robot_pose.matrix()));
    EXPECT_TRUE(stamped.T_world_body.at(i).matrix().isApprox(robot_pose.matrix()));
    EXPECT_TRUE(scene.scan(i).objects.at(0).T_map_object.matrix().isApprox(car_pose.matrix()));
    EXPECT_TRUE(car.T_world_body.at(i).matrix().isApprox(car_pose.matrix()));
    EXPECT_TRUE(rows[i].T_map_object.matrix().isApprox(car_pose.matrix(), 1e-4));
    EXPECT_EQ(scene.cloud(i).points.size(), test::small_cloud(i).points.size());
  }
  // Ahead in the map was x, and is y.
  EXPECT_NEAR(scene.scan(3).objects.at(0).velocity_map_mps.y(), 3.0, 1e-9);
  EXPECT_NEAR(scene.scan(3).objects.at(0).velocity_map_mps.x(), 0.0, 1e-9);
}

TEST_F(MoveResults, MapAndShapes) {
  move_by(SE3());
  EXPECT_EQ(read_map(folder_.path() / "static_map.ply").size(), 1U);
  EXPECT_EQ(read_map(folder_.path() / "static_map.pcd").size(), 1U);
  const SceneFile scene(folder_.path() / "scene.mlo");
  ASSERT_EQ(scene.map().size(), 1U);
  EXPECT_LT((scene.map()[0].p_map - map_[0].p_map).norm(), 0.001F);
  EXPECT_EQ(scene.object(3).points.size(), test::small_shape().points.size());
  EXPECT_TRUE(scene.complete());
}

TEST_F(MoveResults, WithoutAMoveTheTableStays) {
  const std::string before = test::read_bytes(folder_.path() / "objects.csv");
  move_by(SE3());
  EXPECT_EQ(test::read_bytes(folder_.path() / "objects.csv"), before);
}

}  // namespace
}  // namespace mlo
