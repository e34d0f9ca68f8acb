#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/evaluation/tracking_evaluation.hpp"
#include "mlo/io/calibration.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/io/pose_files.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/pipeline/track_detections.hpp"
#include "real_data.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

constexpr double kInterval_s = 0.1;

/// A car 20 m ahead that drives at 5 m/s, seen by a lidar that stands; the frame in the middle saw nothing.
DetectionList driving_car(std::size_t frames) {
  DetectionList list;
  for (std::size_t i = 0; i < frames; ++i) {
    if (i == frames / 2) continue;
    const Box3d box{{20.0 + 0.5 * static_cast<double>(i), 1.0, -0.9}, {4.0, 1.6, 1.5}, 0.0};
    list.by_frame[i] = {{.detection = {ObjectClass::car, box, 0.9999}, .image_box_px = {}, .alpha_rad = {}}};
  }
  return list;
}

PoseList standing_lidar(std::size_t frames) {
  PoseList poses;
  for (std::size_t i = 0; i < frames; ++i) poses.frames.push_back(i);
  poses.T_world_body.resize(frames);
  return poses;
}

CameraView forward_camera() {
  CameraView view;
  view.T_camera0_lidar = T_camera0_level();
  view.P2 << 720.0, 0.0, 621.0, 0.0, 0.0, 720.0, 187.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  return view;
}

TEST(TrackDetections, GivesEveryFrameAlsoWithoutDetections) {
  const auto frames = track_detections(driving_car(21), std::nullopt, kInterval_s, {});
  ASSERT_EQ(frames.size(), 21U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].frame, i);
    EXPECT_DOUBLE_EQ(frames[i].stamp_s, 0.1 * static_cast<double>(i));
  }
  ASSERT_EQ(frames[10].objects.size(), 1U);
  EXPECT_EQ(frames[10].objects[0].state, TrackState::coasting);
  EXPECT_EQ(frames[20].objects[0].id, frames[0].objects[0].id);
  EXPECT_TRUE(track_detections({}, std::nullopt, kInterval_s, {}).empty());
}

TEST(TrackDetections, MissingPosesAreNamed) {
  PoseList poses;
  poses.frames = {0, 1};
  poses.T_world_body = {SE3(), SE3()};
  EXPECT_THROW(track_detections(driving_car(5), poses, kInterval_s, {}), InputError);
}

TEST(TrackDetections, TheFutureDoesNotChangeThePast) {
  const auto all = track_detections(driving_car(20), std::nullopt, kInterval_s, {});
  DetectionList first_half = driving_car(20);
  std::erase_if(first_half.by_frame, [](const auto& entry) { return entry.first >= 15; });
  const auto part = track_detections(first_half, std::nullopt, kInterval_s, {});
  for (std::size_t i = 0; i < part.size(); ++i) {
    ASSERT_EQ(part[i].objects.size(), all[i].objects.size());
    EXPECT_EQ(part[i].objects[0].reported, all[i].objects[0].reported);
    EXPECT_EQ(part[i].objects[0].box.center_lidar_m, all[i].objects[0].box.center_lidar_m);
  }
}

TEST(TrackDetections, RecordsAreThoseInTheImage) {
  auto frames = track_detections(driving_car(10), std::nullopt, kInterval_s, {});
  const auto records = kitti_records(frames, forward_camera());
  ASSERT_FALSE(records.empty());
  EXPECT_EQ(records.back().type, "car");
  EXPECT_GT(records.back().image_box.right_px, records.back().image_box.left_px);
  EXPECT_NEAR(records.back().box.center_lidar_m.x(), 24.5, 0.3);
  for (FrameTracks& frame : frames) {
    for (TrackedObject& object : frame.objects) object.box.center_lidar_m.x() *= -1.0;
  }
  EXPECT_TRUE(kitti_records(frames, forward_camera()).empty());
  EXPECT_NEAR(forward_camera().width_deg(), 81.5, 0.1);
}

TEST(TrackDetections, WritesRowsAndTrajectories) {
  const test::TempFolder folder;
  const auto frames = track_detections(driving_car(12), standing_lidar(12), kInterval_s, {});
  write_object_table(folder.path() / "objects.csv", frames);
  write_object_trajectories(folder.path() / "trajectories", frames);
  const PoseList poses = read_trajectory(folder.path() / "trajectories" / "00001.txt");
  ASSERT_GT(poses.T_world_body.size(), 5U);
  EXPECT_NEAR(poses.stamps_s.back(), 1.1, 1e-9);
  EXPECT_NEAR(poses.T_world_body.back().translation().x(), 25.5, 0.3);
}

TrackingScores score(const std::string& object_class, bool with_poses) {
  const auto root = *test::real_data() / "kitti_tracking/training";
  std::vector<SequenceRecords> sequences;
  for (const auto& [name, truth] : read_kitti_sequences(root / "label_02")) {
    const Calibration calibration = read_calibration_file(root / "calib" / (name + ".txt"));
    const DetectionList detections = read_detections({root / "detections" / ("pointrcnn_" + object_class)},
                                                     calibration, {.sequence = name});
    const CameraView view{*calibration.T_camera0_lidar, *calibration.P2, {1242.0, 375.0}};
    std::optional<PoseList> poses;
    if (with_poses) {
      poses = rebased(read_kitti_poses(root / "poses_imu" / (name + ".txt")), *calibration.T_imu_lidar);
    }
    TrackingConfig config;
    config.lifecycle.field_of_view_deg = view.width_deg();
    const auto frames = track_detections(detections, poses, kInterval_s, config);
    sequences.push_back({name, truth, kitti_records(frames, view)});
  }
  return evaluate_tracking(sequences, {.object_class = object_class}).all;
}

// Ten sequences, on line. The bounds are a little below what docs/results.md reports.
TEST(TrackDetections, RealCarsWithPoses) {
  if (!test::real_data()) GTEST_SKIP() << test::kNoRealData;
  const TrackingScores scores = score("car", true);
  EXPECT_GT(scores.hota.hota(), 0.787);
  EXPECT_GT(scores.clear.mota(), 0.866);
  EXPECT_LT(scores.clear.id_switches, 40U);
}

TEST(TrackDetections, RealCarsWithoutPoses) {
  if (!test::real_data()) GTEST_SKIP() << test::kNoRealData;
  const TrackingScores scores = score("car", false);
  EXPECT_GT(scores.hota.hota(), 0.775);
  EXPECT_GT(scores.clear.mota(), 0.855);
}

}  // namespace
}  // namespace mlo
