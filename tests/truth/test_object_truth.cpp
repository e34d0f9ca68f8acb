#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mlo/io/kitti_box.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/truth/object_truth.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

// Camera 0 on the lidar, looking along its x.
SE3 T_camera0_lidar() {
  return {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), Eigen::Vector3d::Zero()};
}

TEST(ObjectTruth, BoxesGoThroughTheLidarToTheMap) {
  const test::TempFolder folder;
  // 20 m ahead of the camera, 2 m to its right, 1.5 m below, 1.5 m high, heading as the camera looks.
  const auto file = folder.write("labels.txt",
                                 "0 3 Car 0 0 0 0 0 9 9 1.5 1.6 4.0 2.0 1.5 20.0 -1.5707963267948966\n"
                                 "0 -1 DontCare -1 -1 -10 0 0 9 9 -1 -1 -1 -1000 -1000 -1000 -10\n"
                                 "7 3 Car 0 0 0 0 0 9 9 1.5 1.6 4.0 2.0 1.5 20.0 0\n");
  PoseList poses;
  poses.frames = {0};
  poses.stamps_s = {4.5};
  // The lidar at (100, 0, 0), turned left by 90 degrees.
  poses.T_world_body = {
      SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ())),
          {100.0, 0.0, 0.0})};
  const auto objects = objects_in_map(read_kitti_tracks(file), poses, T_camera0_lidar());
  ASSERT_EQ(objects.size(), 1U);  // no DontCare, none without a pose
  const ObjectPose& car = objects.front();
  EXPECT_EQ(car.id, 3);
  EXPECT_EQ(car.type, "car");
  EXPECT_EQ(car.stamp_s, 4.5);
  EXPECT_TRUE(car.T_map_object.translation().isApprox(Eigen::Vector3d(102.0, 20.0, -0.75), 1e-9));
  const Eigen::Vector3d heading = car.T_map_object.rotation() * Eigen::Vector3d::UnitX();
  EXPECT_NEAR((heading - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-9);
  EXPECT_TRUE(car.size_lwh_m.isApprox(Eigen::Vector3d(4.0, 1.6, 1.5)));
}

TEST(ObjectTruth, NothingGivesNothing) {
  EXPECT_TRUE(objects_in_map({}, {}, T_camera0_lidar()).empty());
}

}  // namespace
}  // namespace mlo
