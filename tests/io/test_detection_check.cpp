#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/io/detection_check.hpp"
#include "mlo/io/kitti_box.hpp"

namespace mlo {
namespace {

using ::testing::HasSubstr;

constexpr double kGround_m = -1.7;  // z of the ground under the lidar

void add_point(std::vector<Point>& points, const Eigen::Vector3d& p_lidar) {
  points.emplace_back().p_lidar = p_lidar.cast<float>();
}

/// Points on the sides and the top of a box.
void add_surface(std::vector<Point>& points, const Box3d& box, std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  const SE3 T_lidar_object = box.T_lidar_object();
  for (int i = 0; i < 200; ++i) {
    Eigen::Vector3d p(uniform(rng), uniform(rng), uniform(rng));
    const int face = i % 5;
    p(face / 2) = face % 2 == 0 ? 0.5 : -0.5;
    add_point(points, T_lidar_object * p.cwiseProduct(box.size_lwh_m).eval());
  }
}

void add_ground(std::vector<Point>& points) {
  for (double x = -35.0; x < 35.0; x += 0.5) {
    for (double y = -35.0; y < 35.0; y += 0.5) add_point(points, {x, y, kGround_m});
  }
}

/// Cars that stand on the ground in all directions.
struct Scene {
  std::vector<Point> points;
  std::vector<Detection> detections;
};

Scene make_scene() {
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> yaw_rad(-std::numbers::pi, std::numbers::pi);
  Scene scene;
  add_ground(scene.points);
  for (int i = 0; i < 12; ++i) {
    const double azimuth_rad = 0.5 * i;
    const double range_m = 10.0 + 1.5 * i;
    const Box3d box{{range_m * std::cos(azimuth_rad), range_m * std::sin(azimuth_rad), kGround_m + 0.75},
                    {4.2, 1.8, 1.5},
                    yaw_rad(rng)};
    scene.detections.push_back({ObjectClass::car, box, 0.9});
    add_surface(scene.points, box, rng);
  }
  return scene;
}

DetectionCheck check(const Scene& scene, const Calibration& calibration = {}) {
  const std::vector<ScanWithDetections> scans{{scene.points, scene.detections}};
  return check_detections(scans, calibration);
}

DetectionCheck check_after(const std::function<void(Box3d&)>& mistake, const Calibration& calibration = {}) {
  Scene scene = make_scene();
  for (Detection& detection : scene.detections) mistake(detection.box);
  return check(scene, calibration);
}

TEST(DetectionCheck, RightBoxesAreFine) {
  const DetectionCheck result = check(make_scene());
  EXPECT_EQ(result.boxes, 12U);
  EXPECT_EQ(result.boxes_with_points, 12U);
  EXPECT_GT(result.score, 0.99);
  EXPECT_EQ(result.mistake, "");
  EXPECT_EQ(result.problem, "");
}

TEST(DetectionCheck, SmallErrorsOfADetectorAreFine) {
  std::mt19937 rng(1);
  std::normal_distribution<double> noise(0.0, 0.1);
  const DetectionCheck result = check_after([&](Box3d& box) {
    box.center_lidar_m += Eigen::Vector3d(noise(rng), noise(rng), noise(rng));
    box.yaw_rad += 0.5 * noise(rng);
  });
  EXPECT_EQ(result.problem, "");
}

TEST(DetectionCheck, NamesTheMistakesThatAreUsual) {
  const auto mistake = [](const std::function<void(Box3d&)>& make) { return check_after(make).mistake; };
  EXPECT_THAT(mistake([](Box3d& b) { b.center_lidar_m.z() -= 0.5 * b.size_lwh_m.z(); }),
              HasSubstr("bottom face"));
  EXPECT_THAT(mistake([](Box3d& b) { b.center_lidar_m.z() += 0.5 * b.size_lwh_m.z(); }),
              HasSubstr("too high"));
  EXPECT_THAT(mistake([](Box3d& b) { std::swap(b.size_lwh_m.x(), b.size_lwh_m.y()); }),
              HasSubstr("length and width"));
  EXPECT_THAT(mistake([](Box3d& b) { std::swap(b.size_lwh_m.x(), b.size_lwh_m.z()); }),
              HasSubstr("length and height"));
  EXPECT_THAT(mistake([](Box3d& b) { b.yaw_rad *= 180.0 / std::numbers::pi; }), HasSubstr("degrees"));
  EXPECT_THAT(mistake([](Box3d& b) { b.yaw_rad = -b.yaw_rad; }), HasSubstr("wrong sign"));
  EXPECT_THAT(mistake([](Box3d& b) { b.yaw_rad = -b.yaw_rad - 0.5 * std::numbers::pi; }),
              HasSubstr("rotation_y"));
}

TEST(DetectionCheck, FindsTheCameraFrame) {
  Calibration calibration;
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  T.topRightCorner<3, 1>() << 0.1, -0.3, -0.4;
  calibration.T_camera0_lidar = SE3::from_matrix(T);
  const auto as_camera = [&](Box3d& box) {
    const KittiBox kitti = box_in_camera(box, *calibration.T_camera0_lidar);
    box.center_lidar_m = kitti.bottom_camera0_m;
    box.yaw_rad = kitti.rotation_y_rad;
  };
  const DetectionCheck result = check_after(as_camera, calibration);
  EXPECT_THAT(result.mistake, HasSubstr("camera's frame"));
  EXPECT_THAT(result.problem, HasSubstr("camera's frame"));
  EXPECT_GT(result.best_score, 0.95);
  EXPECT_LT(result.score, 0.3);
  EXPECT_THAT(check_after(as_camera).mistake, HasSubstr("camera's frame")) << "without the calibration";
}

TEST(DetectionCheck, SaysWhenNothingExplainsEmptyBoxes) {
  const DetectionCheck result = check_after([](Box3d& box) { box.center_lidar_m.x() += 6.0; });
  EXPECT_LT(result.boxes_with_points, 4U);
  EXPECT_EQ(result.mistake, "");
  EXPECT_THAT(result.problem, HasSubstr("no usual mistake"));
}

TEST(DetectionCheck, NothingToTellFromIsNoProblem) {
  EXPECT_EQ(check_detections({}, {}).problem, "");
  Scene scene = make_scene();
  for (Detection& detection : scene.detections) detection.confidence = 0.1;
  EXPECT_EQ(check(scene).boxes, 0U);
  scene = make_scene();
  for (Detection& detection : scene.detections) detection.box.center_lidar_m.x() = std::nan("");
  EXPECT_EQ(check(scene).boxes, 0U);
  EXPECT_EQ(check(scene).problem, "");
}

TEST(DetectionCheck, ScansWithoutPointsAreAProblem) {
  Scene scene = make_scene();
  scene.points.clear();
  const DetectionCheck result = check(scene);
  EXPECT_EQ(result.boxes_with_points, 0U);
  EXPECT_THAT(result.problem, HasSubstr("0 of 12 boxes"));
}

}  // namespace
}  // namespace mlo
