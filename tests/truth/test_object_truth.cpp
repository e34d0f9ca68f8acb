#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
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
  const auto objects = objects_in_map(boxes_in_lidar(read_kitti_tracks(file), T_camera0_lidar()), poses);
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

// A tracklet file with the elements that matter: tracklet 0 in frame 2, tracklet 1 in frames 0 and 1.
constexpr const char* kTracklets = R"(<boost_serialization><tracklets><count>2</count>
<item><objectType>Van</objectType><h>2</h><w>1.8</w><l>4.4</l><first_frame>2</first_frame>
<poses><count>1</count><item><tx>13.5</tx><ty>4.5</ty><tz>-1.7</tz><rx>0</rx><ry>0</ry><rz>0.5</rz></item></poses></item>
<item><objectType>Pedestrian</objectType><h>1.8</h><w>0.6</w><l>0.7</l><first_frame>0</first_frame>
<poses><count>2</count><item><tx>1</tx><ty>2</ty><tz>-1.6</tz><rx>0</rx><ry>0</ry><rz>0</rz></item>
<item><tx>1.5</tx><ty>2</ty><tz>-1.6</tz><rx>0</rx><ry>0</ry><rz>0</rz></item></poses></item>
</tracklets></boost_serialization>)";

TEST(ObjectTruth, TrackletsStandOnTheirPlace) {
  const test::TempFolder folder;
  const auto boxes = read_tracklets(folder.write("tracklet_labels.xml", kTracklets));
  ASSERT_EQ(boxes.size(), 3U);
  EXPECT_EQ(boxes[0].frame, 2U);
  EXPECT_EQ(boxes[0].id, 0);
  EXPECT_EQ(boxes[0].type, "van");
  EXPECT_TRUE(boxes[0].box_lidar.center_lidar_m.isApprox(Eigen::Vector3d(13.5, 4.5, -0.7)));
  EXPECT_TRUE(boxes[0].box_lidar.size_lwh_m.isApprox(Eigen::Vector3d(4.4, 1.8, 2.0)));
  EXPECT_EQ(boxes[0].box_lidar.yaw_rad, 0.5);
  EXPECT_EQ(boxes[2].frame, 1U);
  EXPECT_EQ(boxes[2].id, 1);
  EXPECT_EQ(boxes[2].box_lidar.center_lidar_m.x(), 1.5);
}

TEST(ObjectTruth, BrokenTrackletsNameTheFile) {
  const test::TempFolder folder;
  EXPECT_THROW(read_tracklets(folder.write("a.xml", "<html></html>")), InputError);
  const std::string cut = std::string(kTracklets).substr(0, 330);
  EXPECT_THROW(read_tracklets(folder.write("b.xml", cut)), InputError);
  EXPECT_TRUE(read_tracklets(folder.write("c.xml", "<tracklets></tracklets>")).empty());
}

TEST(ObjectTruth, NothingGivesNothing) {
  EXPECT_TRUE(objects_in_map({}, {}).empty());
  EXPECT_TRUE(boxes_in_lidar({}, T_camera0_lidar()).empty());
}

}  // namespace
}  // namespace mlo
