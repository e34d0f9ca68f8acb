#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mlo/io/kitti_box.hpp"
#include "mlo/simulator/detection_noise.hpp"

namespace mlo::simulator {
namespace {

std::vector<ObjectTruth> many_cars(double distance_m, std::size_t points, int count = 2000) {
  std::vector<ObjectTruth> objects;
  for (int i = 1; i <= count; ++i) {
    ObjectTruth object;
    object.id = i;
    object.box_lidar = {{distance_m, 0.0, -0.9}, {4.2, 1.7, 1.5}, 0.3};
    object.points = points;
    objects.push_back(object);
  }
  return objects;
}

TEST(DetectionNoise, WithoutErrorsDetectionsAreTheTruth) {
  const std::vector<ObjectTruth> cars = many_cars(20.0, 100, 5);
  const std::vector<Detection> detections = detect(cars, DetectorErrors::none(), Random(1));
  ASSERT_EQ(detections.size(), cars.size());
  for (const Detection& detection : detections) {
    EXPECT_EQ(detection.box.center_lidar_m, cars[0].box_lidar.center_lidar_m);
    EXPECT_EQ(detection.box.size_lwh_m, cars[0].box_lidar.size_lwh_m);
    EXPECT_NEAR(detection.box.yaw_rad, 0.3, 1e-12);
    EXPECT_EQ(detection.confidence, 1.0);
  }
}

TEST(DetectionNoise, PositionNoiseGrowsWithDistanceAsDocumented) {
  DetectorErrors errors = DetectorErrors::none();
  errors.position_m = 0.1;
  errors.position_per_m = 0.005;
  for (const double distance : {10.0, 50.0}) {
    double squares = 0.0;
    const std::vector<Detection> detections = detect(many_cars(distance, 100), errors, Random(2));
    for (const Detection& detection : detections) squares += std::pow(detection.box.center_lidar_m.y(), 2);
    const double expected = 0.1 + 0.005 * distance;
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(detections.size())), expected, 0.06 * expected);
  }
}

TEST(DetectionNoise, MissesFlipsAndFalsePositivesHaveTheirShares) {
  DetectorErrors errors = DetectorErrors::none();
  errors.miss_share = 0.3;
  errors.flip_share = 0.2;
  const std::vector<Detection> detections = detect(many_cars(20.0, 1000), errors, Random(3));
  EXPECT_NEAR(static_cast<double>(detections.size()) / 2000.0, 0.7, 0.04);
  double flipped = 0.0;
  for (const Detection& detection : detections) {
    flipped += std::cos(detection.box.yaw_rad - 0.3) < 0.0 ? 1.0 : 0.0;
  }
  EXPECT_NEAR(flipped / static_cast<double>(detections.size()), 0.2, 0.04);

  errors.false_positives = 1.5;
  double found = 0.0;
  for (std::uint64_t frame = 0; frame < 1000; ++frame)
    found += static_cast<double>(detect({}, errors, Random(frame)).size());
  EXPECT_NEAR(found / 1000.0, 1.5, 0.15);
}

TEST(DetectionNoise, FewerReturnsAreMissedMoreOften) {
  DetectorErrors errors = DetectorErrors::none();
  errors.half_points = 12.0;
  const auto share = [&](std::size_t points) {
    return static_cast<double>(detect(many_cars(20.0, points), errors, Random(4)).size()) / 2000.0;
  };
  EXPECT_NEAR(share(12), 0.5, 0.04);
  EXPECT_GT(share(100), 0.97);
  EXPECT_EQ(share(kMinLabelPoints - 1), 0.0);
}

TEST(DetectionNoise, WhatDetectorsCannotKnowIsNotReported) {
  std::vector<ObjectTruth> objects = many_cars(20.0, 100, 2);
  objects[0].detectable = false;
  objects[1].box_lidar.center_lidar_m.x() = 500.0;
  EXPECT_TRUE(detect(objects, DetectorErrors::none(), Random(1)).empty());
}

TEST(Camera, ABoxAheadIsSeenWholeAndOneBehindNotAtAll) {
  const Rig rig;
  const auto ahead = project(rig, {{20.0, 0.0, -0.9}, {4.0, 1.7, 1.5}, 0.0});
  ASSERT_TRUE(ahead);
  EXPECT_NEAR(ahead->truncation, 0.0, 1e-9);
  EXPECT_NEAR(ahead->box.right_px - ahead->box.left_px, 720.0 * 1.7 / 17.7, 4.0);  // the near face
  EXPECT_FALSE(project(rig, {{-20.0, 0.0, -0.9}, {4.0, 1.7, 1.5}, 0.0}));
}

TEST(Camera, ABoxAtTheEdgeIsTruncatedByItsShareOutside) {
  const Rig rig;
  const Box3d box{{10.0, 8.6, -0.9}, {0.1, 2.0, 1.5}, 0.0};  // centred about the image's left border
  const auto view = project(rig, box);
  ASSERT_TRUE(view);
  EXPECT_EQ(view->box.left_px, 0.0);
  EXPECT_GT(view->truncation, 0.2);
  EXPECT_LT(view->truncation, 0.8);
}

TEST(Camera, KittiAnglesOfACarAheadDrivingAwayAreMinusHalfPi) {
  const Rig rig;
  const KittiBox box = box_in_camera({{20.0, 0.0, -0.9}, {4.0, 1.7, 1.5}, 0.0}, rig.T_camera_lidar);
  EXPECT_NEAR(box.rotation_y_rad, -0.5 * std::numbers::pi, 0.03);
  EXPECT_NEAR(observation_angle_rad(box), box.rotation_y_rad, 0.03);
  EXPECT_NEAR(box.bottom_camera0_m.z(), 20.0, 0.5);
  EXPECT_NEAR(box.bottom_camera0_m.y(), 1.65 - 0.08, 0.4);
}

}  // namespace
}  // namespace mlo::simulator
