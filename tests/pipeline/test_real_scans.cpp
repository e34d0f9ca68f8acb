#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mlo/io/dataset.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/pipeline/pipeline.hpp"
#include "real_data.hpp"

namespace mlo {
namespace {

constexpr std::size_t kRealScans = 20;

/// Mean error of the motion from scan to scan over the first scans [m]; no scan may be lost.
double mean_step_error_m(const std::filesystem::path& folder, const std::filesystem::path& truth_file,
                         RegionOfInterest roi) {
  const Dataset dataset = open_dataset(folder, {});
  const PoseList truth = read_trajectory(truth_file);
  PipelineConfig config;
  config.sensor = dataset.sensor;
  config.input.roi = roi;
  Pipeline pipeline(config);
  double sum_m = 0.0;
  SE3 previous;
  for (std::size_t i = 0; i < kRealScans; ++i) {
    const ScanReading reading = dataset.scans->read(i);
    if (!reading.scan) {
      ADD_FAILURE() << reading.problem;
      continue;
    }
    const FrameResult result = pipeline.process(*reading.scan, {});
    EXPECT_TRUE(result.localised()) << "scan " << i;
    if (i > 0) {
      const SE3 true_step = truth.T_world_body.at(i - 1).inverse() * truth.T_world_body.at(i);
      sum_m += (true_step.inverse() * (previous.inverse() * result.T_map_lidar)).translation().norm();
    }
    previous = result.T_map_lidar;
  }
  return sum_m / static_cast<double>(kRealScans - 1);
}

TEST(RealScans, CompensatedOdometryScansAreFollowed) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const auto folder = *data / "kitti_odometry" / "sequences" / "04";
  EXPECT_LT(mean_step_error_m(folder, *data / "truth_lidar" / "04.txt", RegionOfInterest::full), 0.022);
}

TEST(RealScans, RawScansAreFollowedWithTheWholeAndTheCamerasView) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const auto folder = *data / "kitti_raw" / "2011_09_26" / "2011_09_26_drive_0009_sync";
  const auto truth = *data / "truth_lidar" / "0009_vel.txt";
  EXPECT_LT(mean_step_error_m(folder, truth, RegionOfInterest::full), 0.025);
  EXPECT_LT(mean_step_error_m(folder, truth, RegionOfInterest::camera), 0.025);
}

std::vector<Eigen::Vector3d> positions(const Dataset& dataset) {
  PipelineConfig config;
  config.sensor = dataset.sensor;
  Pipeline pipeline(config);
  std::vector<Eigen::Vector3d> path;
  for (std::size_t i = 0; i < kRealScans; ++i)
    path.push_back(pipeline.process(*dataset.scans->read(i).scan, {}).T_map_lidar.translation());
  return path;
}

// A turn with distorted scans: rounding that depends on the thread shows here, and not on short simulated
// drives.
TEST(RealScans, AnyNumberOfThreadsGivesTheSameBits) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const Dataset dataset = open_dataset(*data / "kitti_raw" / "2011_09_26" / "2011_09_26_drive_0005_sync", {});
  std::vector<std::vector<Eigen::Vector3d>> paths;
  for (const std::size_t threads : {1U, 2U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    paths.push_back(positions(dataset));
  }
  EXPECT_TRUE(paths[0] == paths[1]);
  EXPECT_TRUE(paths[0] == paths[2]);
}

}  // namespace
}  // namespace mlo
