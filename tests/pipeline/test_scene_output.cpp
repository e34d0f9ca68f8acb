#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/pipeline/pipeline.hpp"
#include "mlo/pipeline/scene_output.hpp"
#include "mlo/scene/scene_file.hpp"
#include "pipeline/street.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

constexpr std::size_t kSceneScans = 6;

/// What the pipeline makes of distorted scans of a street with a parked car that is detected.
std::vector<FrameResult> street_results() {
  Pipeline pipeline(test::street_config());
  std::vector<FrameResult> results;
  for (std::size_t i = 0; i < kSceneScans; ++i) {
    const auto sweeps = static_cast<double>(i);
    const std::vector<Detection> detections{test::parked_car(sweeps)};
    results.push_back(pipeline.process(test::street_scan(i, sweeps, false), detections));
  }
  return results;
}

/// From a place to the nearest face of a block, or to the ground.
double distance_to_street_m(const Eigen::Vector3d& p_world) {
  double nearest = std::abs(p_world.z());
  for (const test::Block& block : test::street_blocks()) {
    const Eigen::Array3d outside = (block.min_world - p_world).cwiseMax(p_world - block.max_world).array();
    const double distance =
        outside.maxCoeff() <= 0.0 ? -outside.maxCoeff() : outside.max(0.0).matrix().norm();
    nearest = std::min(nearest, distance);
  }
  return nearest;
}

/// Mean over the points of a scan's cloud, in place by the scan's pose.
double mean_distance_to_street_m(const FrameResult& result) {
  const SceneCloud cloud = scene_cloud(result, 0.2);
  double sum = 0.0;
  for (const ScenePoint& point : cloud.points) {
    sum += distance_to_street_m(test::street_pose(0.0) * (result.T_map_lidar * point.p.cast<double>()));
  }
  return sum / static_cast<double>(cloud.points.size());
}

TEST(SceneOutput, CloudsAreWithoutDistortion) {
  const FrameResult last = street_results().back();
  FrameResult as_measured = last;
  as_measured.motion = SweepMotion::none();
  as_measured.T_reference_stamp = SE3();
  EXPECT_LT(mean_distance_to_street_m(last), 0.03);
  EXPECT_GT(mean_distance_to_street_m(as_measured), 2.0 * mean_distance_to_street_m(last));
}

TEST(SceneOutput, PointsOfAnObjectCarryItsTrack) {
  const FrameResult last = street_results().back();
  ASSERT_EQ(last.objects.size(), 1U);
  std::size_t of_car = 0;
  for (const PointGroup& group : scene_cloud(last, 0.2).groups) {
    if (group.label == MapLabel::object) {
      EXPECT_EQ(group.object, last.objects[0].reported ? last.objects[0].id : 0);
      of_car += group.count;
    }
  }
  EXPECT_EQ(of_car, last.percept.objects[0].points.size());
  EXPECT_GT(of_car, 20U);
}

TEST(SceneOutput, TheEnvironmentIsThinned) {
  const FrameResult last = street_results().back();
  EXPECT_LT(scene_cloud(last, 1.0).points.size(), scene_cloud(last, 0.2).points.size());
}

TEST(SceneOutput, ScansHaveThePoseAndTheReportedObjects) {
  for (const FrameResult& result : street_results()) {
    const SceneScan scan = scene_scan(result);
    EXPECT_EQ(scan.frame, result.frame);
    EXPECT_EQ(scan.status, result.first ? ScanStatus::first : ScanStatus::localised);
    EXPECT_EQ(scan.T_map_lidar.matrix(), result.T_map_lidar.matrix());
    EXPECT_EQ(scan.covariance, result.refinement.covariance);
    EXPECT_EQ(scan.objects.size(), static_cast<std::size_t>(result.objects.at(0).reported ? 1 : 0));
  }
  EXPECT_EQ(scene_scan(street_results().back()).objects.size(), 1U);
}

TEST(SceneOutput, ScansAndSkippedScansAreInTheFile) {
  const test::TempFolder folder;
  const std::filesystem::path path = folder.path() / "scene.mlo";
  {
    SceneOutput output(path, SceneMeta(), {});
    for (FrameResult& result : street_results()) output.write(std::move(result));
    output.write_skipped(kSceneScans, 0.6, "no file", {});
    output.finish();
  }
  const SceneFile scene(path);
  ASSERT_EQ(scene.num_scans(), kSceneScans + 1);
  EXPECT_EQ(scene.scan(0).status, ScanStatus::first);
  EXPECT_GT(scene.cloud(0).points.size(), 500U);
  EXPECT_EQ(scene.scan(kSceneScans).status, ScanStatus::skipped);
  EXPECT_EQ(scene.scan(kSceneScans).problem, "no file");
  EXPECT_TRUE(scene.cloud(kSceneScans).points.empty());
}

TEST(SceneOutput, WithoutCloudsTheFileHasNone) {
  const test::TempFolder folder;
  const std::filesystem::path path = folder.path() / "scene.mlo";
  {
    SceneOutput output(path, SceneMeta(), {.clouds = false});
    for (FrameResult& result : street_results()) output.write(std::move(result));
    output.finish();
  }
  EXPECT_EQ(SceneFile(path).stored_bytes(ChunkType::cloud), 0U);
}

TEST(SceneOutput, AFullDiskIsAnInputError) {
  EXPECT_THROW(SceneOutput("/dev/full", SceneMeta(), {}), InputError);
}

}  // namespace
}  // namespace mlo
