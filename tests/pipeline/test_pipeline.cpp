#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "mlo/pipeline/find_objects.hpp"
#include "mlo/pipeline/pipeline.hpp"
#include "pipeline/street.hpp"

namespace mlo {
namespace {

/// The pose that the pipeline should give for a scan taken at `sweeps`, the first one having been at `first`.
SE3 expected_pose(double sweeps, double first = 0.0) {
  return test::street_pose(first).inverse() * test::street_pose(sweeps);
}

void expect_near(const SE3& pose, const SE3& truth, double within_m, double within_deg) {
  const SE3 error = truth.inverse() * pose;
  EXPECT_LT(error.translation().norm(), within_m);
  EXPECT_LT(error.rotation_angle_rad() * 180.0 / std::numbers::pi, within_deg);
}

Scan empty_scan(std::size_t frame) {
  Scan scan = test::street_scan(frame, static_cast<double>(frame), true);
  scan.points.clear();
  return scan;
}

bool in_car(const MapPoint& point) {
  const test::Block car = test::street_blocks().back();
  const Eigen::Vector3d p = test::street_pose(0.0) * point.p_map.cast<double>();
  return (p.array() > car.min_world.array() - 0.05).all() &&
         (p.array() < car.max_world.array() + 0.05).all() && p.z() > 0.3;
}

std::size_t car_points_in_map(bool with_detections) {
  Pipeline pipeline(test::street_config());
  for (std::size_t i = 0; i < 6; ++i) {
    const auto sweeps = static_cast<double>(i);
    std::vector<Detection> detections;
    if (with_detections) detections.push_back(test::parked_car(sweeps));
    const FrameResult result = pipeline.process(test::street_scan(i, sweeps, true), detections);
    EXPECT_EQ(result.counts.objects, detections.size());
    EXPECT_EQ(result.counts.object_points > 20, with_detections);
  }
  const auto points = pipeline.static_map().points();
  return static_cast<std::size_t>(std::count_if(points.begin(), points.end(), in_car));
}

TEST(Pipeline, FollowsTheMotionOfCompensatedScans) {
  Pipeline pipeline(test::street_config());
  for (std::size_t i = 0; i < 12; ++i) {
    const auto sweeps = static_cast<double>(i);
    const FrameResult result = pipeline.process(test::street_scan(i, sweeps, true), {});
    EXPECT_TRUE(result.localised()) << i;
    EXPECT_EQ(result.first, i == 0);
    EXPECT_EQ(result.frame, i);
    expect_near(result.T_map_lidar, expected_pose(sweeps), 0.03, 0.1);
  }
  EXPECT_GT(pipeline.static_map().points().size(), 1000U);
}

FrameResult last_of_ten_distorted_scans() {
  Pipeline pipeline(test::street_config());
  FrameResult result;
  for (std::size_t i = 0; i < 10; ++i) {
    result = pipeline.process(test::street_scan(i, static_cast<double>(i), false), {});
  }
  EXPECT_TRUE(result.localised());
  return result;
}

TEST(Pipeline, FollowsTheMotionOfDistortedScans) {
  expect_near(last_of_ten_distorted_scans().T_map_lidar, expected_pose(9.0), 0.03, 0.1);
}

TEST(Pipeline, WhatDetectionsEncloseIsNotInTheStaticMap) {
  EXPECT_GT(car_points_in_map(false), 20U);
  EXPECT_EQ(car_points_in_map(true), 0U);
}

TEST(Pipeline, AnEmptyScanIsPredictedAndTheNextOneFound) {
  Pipeline pipeline(test::street_config());
  for (std::size_t i = 0; i < 5; ++i) {
    pipeline.process(test::street_scan(i, static_cast<double>(i), true), {});
  }
  const std::size_t map_points = pipeline.static_map().points().size();
  const FrameResult lost = pipeline.process(empty_scan(5), {});
  EXPECT_FALSE(lost.localised());
  EXPECT_EQ(lost.refinement.status, EstimateStatus::too_few_matches);
  EXPECT_EQ(pipeline.static_map().points().size(), map_points);
  expect_near(lost.T_map_lidar, expected_pose(5.0), 0.1, 0.2);
  for (std::size_t i = 6; i < 9; ++i) {
    const FrameResult found = pipeline.process(test::street_scan(i, static_cast<double>(i), true), {});
    EXPECT_TRUE(found.localised());
    expect_near(found.T_map_lidar, expected_pose(static_cast<double>(i)), 0.03, 0.1);
  }
}

TEST(Pipeline, AnEmptyFirstScanDoesNotKeepLaterOnesFromTheMap) {
  Pipeline pipeline(test::street_config());
  pipeline.process(empty_scan(0), {});
  for (std::size_t i = 1; i < 4; ++i)
    pipeline.process(test::street_scan(i, static_cast<double>(i), true), {});
  const FrameResult result = pipeline.process(test::street_scan(4, 4.0, true), {});
  EXPECT_TRUE(result.localised());
  const SE3 T_first_found = pipeline.predict_poses(0.0).T_map_lidar;
  const FrameResult next = pipeline.process(test::street_scan(5, 5.0, true), {});
  expect_near(T_first_found.inverse() * next.T_map_lidar, test::street_motion(), 0.03, 0.1);
}

TEST(Pipeline, ARobotThatWasCarriedAwayStartsANewMap) {
  Pipeline pipeline(test::street_config());
  for (std::size_t i = 0; i < 4; ++i) {
    pipeline.process(test::street_scan(i, static_cast<double>(i), true), {});
  }
  // Another place, with nothing of the first one in reach of the matching: the same street, 50 m higher.
  bool found_again = false;
  for (std::size_t i = 4; i < 14; ++i) {
    Scan scan = test::street_scan(i, static_cast<double>(i), true);
    for (Point& point : scan.points) point.p_lidar.z() += 50.0F;
    found_again = pipeline.process(scan, {}).localised();
  }
  EXPECT_TRUE(found_again);
}

TEST(Pipeline, AGapInTheStampsIsBridgedByTheMotion) {
  Pipeline pipeline(test::street_config());
  FrameResult result;
  for (const std::size_t i : {0U, 1U, 2U, 3U, 4U, 8U, 9U}) {
    result = pipeline.process(test::street_scan(i, static_cast<double>(i), false), {});
    EXPECT_TRUE(result.localised()) << i;
    expect_near(result.T_map_lidar, expected_pose(static_cast<double>(i)), i < 2 ? 0.1 : 0.04, 0.2);
  }
  expect_near(pipeline.predict_poses(2.0).T_map_lidar, expected_pose(11.0), 0.06, 0.2);
}

TEST(Pipeline, OneScanAloneIsTheOrigin) {
  Pipeline pipeline(test::street_config());
  EXPECT_EQ(pipeline.predict_poses(1.0).T_map_lidar.matrix(), SE3().matrix());
  const FrameResult result = pipeline.process(test::street_scan(0, 0.0, false), {});
  EXPECT_TRUE(result.first);
  EXPECT_TRUE(result.localised());
  EXPECT_EQ(result.T_map_lidar.matrix(), SE3().matrix());
  EXPECT_EQ(result.T_odom_lidar.matrix(), SE3().matrix());
  EXPECT_EQ(result.refinement.status, EstimateStatus::not_run);
  EXPECT_GT(pipeline.static_map().points().size(), 500U);
}

TEST(Pipeline, WithoutOdometryTheMapAloneIsFollowed) {
  PipelineConfig config = test::street_config();
  config.odometry.enabled = false;
  Pipeline pipeline(config);
  FrameResult result;
  for (std::size_t i = 0; i < 8; ++i) {
    result = pipeline.process(test::street_scan(i, static_cast<double>(i), true), {});
    EXPECT_EQ(result.odometry.status, EstimateStatus::not_run);
  }
  expect_near(result.T_map_lidar, expected_pose(7.0), 0.03, 0.1);
}

TEST(Pipeline, MapsPerClassFollowTheMotionToo) {
  PipelineConfig config = test::street_config();
  config.mapping.local_map.separate_classes = true;
  config.mapping.refinement.shape_model = ShapeModel::loam;
  Pipeline pipeline(config);
  FrameResult result;
  for (std::size_t i = 0; i < 8; ++i) {
    result = pipeline.process(test::street_scan(i, static_cast<double>(i), true), {});
  }
  expect_near(result.T_map_lidar, expected_pose(7.0), 0.05, 0.2);
}

TEST(Pipeline, LooksForObjectsOnlyWhereNoBoxesAreGiven) {
  PipelineConfig config;
  config.sensor = test::small_lidar();
  config.detection.cluster.min_probability = 0.0;  // all that it judges
  config.detection.cluster.min_candidate = 0.0;
  const Scan scan = test::street_scan(0, 0.0, true);
  const FrameResult found = Pipeline(config).process(scan);
  EXPECT_GT(found.counts.objects, 0U);
  EXPECT_EQ(found.counts.objects, find_objects(scan, std::nullopt, config).objects.size());
  EXPECT_GE(find_object_candidates(scan, config).size(), found.counts.objects);
  EXPECT_EQ(Pipeline(config).process(scan, {}).counts.objects, 0U);
  config.detection.detector = Detector::none;
  EXPECT_EQ(Pipeline(config).process(scan).counts.objects, 0U);
}

}  // namespace
}  // namespace mlo
