#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/io/dataset.hpp"
#include "mlo/io/detection_check.hpp"
#include "mlo/io/detections.hpp"
#include "mlo/io/kitti_box.hpp"
#include "real_data.hpp"

// KITTI tracking 0000 (the scans of raw drive 0005) with its labels and published detections.
namespace mlo {
namespace {

using test::kNoRealData;
using test::real_data;
using ::testing::HasSubstr;

constexpr double kAnyStamp_s = 0.0;  // KITTI's detections go by frames
const Eigen::Vector2d kImageSize_px(1242.0, 375.0);

struct Sequence {
  std::filesystem::path folder;
  Dataset dataset;
};

Sequence open_sequence(const std::filesystem::path& data) {
  const std::filesystem::path folder = data / "kitti_tracking" / "training";
  return {folder, open_dataset(data / "kitti_tracking", {.format = "kitti_tracking", .sequence = "0000"})};
}

DetectionList read_list(const Sequence& sequence, const std::vector<std::string>& names) {
  std::vector<std::filesystem::path> paths;
  for (const std::string& name : names) paths.push_back(sequence.folder / name);
  return read_detections(paths, sequence.dataset.calibration, {.sequence = "0000"});
}

/// Every 15th scan with its detections, changed by a mistake.
DetectionCheck check(
    const Sequence& sequence, const DetectionList& list,
    const std::function<void(Box3d&)>& mistake = [](Box3d&) {}) {
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < sequence.dataset.scans->size(); i += 15) {
    scans.push_back(sequence.dataset.scans->read(i).scan.value());
  }
  std::vector<ScanWithDetections> input;
  for (const Scan& scan : scans) {
    ScanWithDetections& one = input.emplace_back();
    one.points = scan.points;
    for (const DetectionRecord& record : list.at(scan.frame, kAnyStamp_s)) {
      one.detections.push_back(record.detection);
      mistake(one.detections.back().box);
    }
  }
  return check_detections(input, sequence.dataset.calibration);
}

TEST(RealDetections, PublishedOnesFitTheScans) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const Sequence sequence = open_sequence(*data);
  for (const std::string name : {"detections/pointrcnn_car", "detections/pointgnn_car", "label_02"}) {
    const DetectionCheck result = check(sequence, read_list(sequence, {name}));
    EXPECT_GT(result.boxes, 15U) << name;
    EXPECT_GT(result.boxes_with_points, result.boxes * 9 / 10) << name;
    EXPECT_EQ(result.problem, "") << name << ", score " << result.score << " of " << result.best_score;
  }
}

TEST(RealDetections, TheMistakesAreFound) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const Sequence sequence = open_sequence(*data);
  const DetectionList list = read_list(sequence, {"detections/pointrcnn_car"});
  const SE3 T_camera0_lidar = sequence.dataset.calibration.T_camera0_lidar.value();
  const auto mistake = [&](const std::function<void(Box3d&)>& make) {
    return check(sequence, list, make).mistake;
  };
  EXPECT_THAT(mistake([&](Box3d& b) {
                const KittiBox kitti = box_in_camera(b, T_camera0_lidar);
                b = {kitti.bottom_camera0_m, b.size_lwh_m, kitti.rotation_y_rad};
              }),
              HasSubstr("camera's frame"));
  EXPECT_THAT(mistake([](Box3d& b) { b.center_lidar_m.z() -= 0.5 * b.size_lwh_m.z(); }),
              HasSubstr("bottom face"));
  EXPECT_THAT(mistake([](Box3d& b) { std::swap(b.size_lwh_m.x(), b.size_lwh_m.y()); }),
              HasSubstr("length and width"));
  EXPECT_THAT(mistake([](Box3d& b) { b.yaw_rad *= 180.0 / std::numbers::pi; }), HasSubstr("degrees"));
  EXPECT_THAT(mistake([](Box3d& b) { b.yaw_rad = -b.yaw_rad; }), HasSubstr("wrong sign"));
  EXPECT_THAT(mistake([](Box3d& b) { b.yaw_rad = -b.yaw_rad - 0.5 * std::numbers::pi; }),
              HasSubstr("rotation_y"));
}

TEST(RealDetections, ClassesOfOneDetectorAreMerged) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const Sequence sequence = open_sequence(*data);
  const DetectionList cars = read_list(sequence, {"detections/pointrcnn_car"});
  const DetectionList all = read_list(
      sequence,
      {"detections/pointrcnn_car", "detections/pointrcnn_pedestrian", "detections/pointrcnn_cyclist"});
  EXPECT_GT(all.count(), cars.count() + 100);
  for (const auto& [frame, records] : all.by_frame) {
    for (const DetectionRecord& record : records) {
      EXPECT_GT(record.detection.confidence, 0.0);
      EXPECT_LT(record.detection.confidence, 1.0);
    }
  }
}

double overlap(const Box2d& a, const Box2d& b) {
  const auto area = [](const Box2d& r) {
    return std::max(0.0, r.right_px - r.left_px) * std::max(0.0, r.bottom_px - r.top_px);
  };
  const double common = area({std::max(a.left_px, b.left_px), std::max(a.top_px, b.top_px),
                              std::min(a.right_px, b.right_px), std::min(a.bottom_px, b.bottom_px)});
  return common / (area(a) + area(b) - common);
}

TEST(RealDetections, BoxesProjectToTheAnnotatedRectangles) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const Sequence sequence = open_sequence(*data);
  const Calibration& calibration = sequence.dataset.calibration;
  const DetectionList labels = read_list(sequence, {"label_02"});
  std::vector<double> overlaps;
  std::vector<double> angles_rad;
  for (const auto& [frame, records] : labels.by_frame) {
    for (const DetectionRecord& record : records) {
      if (record.detection.object_class == ObjectClass::other) continue;
      const KittiBox box = box_in_camera(record.detection.box, calibration.T_camera0_lidar.value());
      const auto image = project_box(box, calibration.P2.value(), kImageSize_px);
      overlaps.push_back(image ? overlap(*image, record.image_box_px.value()) : 0.0);
      angles_rad.push_back(std::abs(
          std::remainder(observation_angle_rad(box) - record.alpha_rad.value(), 2.0 * std::numbers::pi)));
    }
  }
  ASSERT_GT(overlaps.size(), 300U);
  const auto median = [](std::vector<double>& values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
  };
  EXPECT_GT(median(overlaps), 0.9);
  EXPECT_LT(median(angles_rad), 0.02);
}

}  // namespace
}  // namespace mlo
