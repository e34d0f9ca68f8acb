#include <numbers>

#include <gtest/gtest.h>

#include "mlo/io/kitti_tracks.hpp"
#include "mlo/truth/detection_truth.hpp"

namespace mlo {
namespace {

constexpr double kPi = std::numbers::pi;

ObjectPose car(std::size_t frame, const Eigen::Vector3d& p_map) {
  ObjectPose object;
  object.frame = frame;
  object.type = "car";
  object.T_map_object = SE3(Eigen::Quaterniond::Identity(), p_map);
  object.size_lwh_m = {4.0, 1.8, 1.5};
  return object;
}

TEST(LabelledBoxes, OfObjectsAllRound) {
  PoseList poses;
  poses.frames = {3, 4};
  poses.T_world_body = {SE3(), SE3(so3_exp({0.0, 0.0, kPi / 2}).normalized(), {10.0, 0.0, 0.0})};
  std::vector<ObjectPose> objects{car(3, {20.0, 0.0, 0.0}), car(4, {10.0, 30.0, 0.0}),
                                  car(5, {0.0, 0.0, 0.0})};
  objects[0].points = 4;
  objects[1].points = 5;
  objects[1].visible_share = 0.5;
  const LabelledFrames frames = labelled_boxes(objects, poses);
  ASSERT_EQ(frames.size(), 2U);
  const LabelledBox& few_points = frames.at(3).front();
  EXPECT_EQ(few_points.occlusion, 3);
  EXPECT_NEAR(few_points.height_px, 721.5 * 1.5 / 20.0, 1e-9);
  const LabelledBox& partly = frames.at(4).front();
  EXPECT_EQ(partly.occlusion, 1);
  EXPECT_LT((partly.box.center_lidar_m - Eigen::Vector3d(30.0, 0.0, 0.0)).norm(), 1e-9);
  EXPECT_NEAR(partly.box.yaw_rad, -kPi / 2, 1e-9);
}

/// A camera at the lidar that looks ahead.
LabelledView view_ahead() {
  LabelledView view;
  view.T_camera0_lidar = T_camera0_level();
  view.P2 << 700.0, 0.0, 621.0, 0.0, 0.0, 700.0, 187.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  return view;
}

TEST(DetectionFrames, KeepWhatTheImageShows) {
  LabelledFrames truth;
  truth[2] = {};
  truth[4] = {{.type = "car", .box = {{20.0, 0.0, 0.0}, {4.0, 1.8, 1.5}, 0.0}, .height_px = 60.0}};
  const auto box_at = [](double x_m) {
    DetectionRecord record;
    record.detection.box = {{x_m, 0.0, 0.0}, {4.0, 1.8, 1.5}, 0.0};
    record.raw_score = 3.0;
    return record;
  };
  DetectionList list;
  list.by_frame[1] = {box_at(10.0)};
  list.by_frame[4] = {box_at(20.0), box_at(-20.0)};
  const auto ahead = detection_frames(truth, list, view_ahead());
  ASSERT_EQ(ahead.size(), 3U);  // frames 2 to 4
  EXPECT_TRUE(ahead[0].detections.empty());
  ASSERT_EQ(ahead[2].detections.size(), 1U);
  EXPECT_EQ(ahead[2].detections[0].type, "car");
  EXPECT_EQ(ahead[2].detections[0].confidence, 3.0);
  EXPECT_NEAR(ahead[2].detections[0].height_px, 700.0 * 1.5 / 18.0, 1.0);
  EXPECT_EQ(ahead[2].truth.size(), 1U);
  EXPECT_EQ(detection_frames(truth, list, std::nullopt)[2].detections.size(), 2U);
  EXPECT_TRUE(detection_frames({}, list, std::nullopt).empty());
}

TEST(LabelledBoxes, OfKittiLabels) {
  ObjectRecord record;
  record.frame = 1;
  record.track_id = 5;
  record.type = "van";
  record.occlusion = 2;
  record.truncation = 1;
  record.image_box = {0.0, 10.0, 20.0, 45.0};
  record.box = {{20.0, 1.0, 0.0}, {4.0, 1.8, 1.5}, 0.3};
  ObjectRecord dont_care;
  const std::vector<ObjectRecord> records{dont_care, record};
  const LabelledFrames frames = labelled_boxes(records, T_camera0_level());
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_TRUE(frames.at(0).empty());
  const LabelledBox& box = frames.at(1).front();
  EXPECT_EQ(box.type, "van");
  EXPECT_EQ(box.height_px, 35.0);
  EXPECT_EQ(box.occlusion, 2);
  EXPECT_EQ(box.truncation, 1);
  EXPECT_LT((box.box.center_lidar_m - record.box.center_lidar_m).norm(), 1e-9);
  EXPECT_NEAR(box.box.yaw_rad, 0.3, 1e-9);
}

}  // namespace
}  // namespace mlo
