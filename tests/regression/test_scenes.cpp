#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "io/file_bytes.hpp"
#include "mlo/evaluation/trajectory_error.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/pipeline/run.hpp"
#include "regression/drive.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using simulator::SceneKind;

/// A short drive and the errors that it may have. Ceilings are some 1.5 times what was measured when they
/// were set (docs/simulation.md), so that a change for the worse shows and a change of rounding does not.
struct Case {
  SceneKind kind;
  double length_m;
  std::size_t scans;
  double trajectory_ate_m;
  double trajectory_rte_m;
  double odometry_ate_m;
};

void PrintTo(const Case& scene, std::ostream* stream) {
  *stream << simulator::name_of(scene.kind);
}

class ShortDrive : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    const Case& scene = GetParam();
    test::simulate_drive({.kind = scene.kind, .length_m = scene.length_m, .seed = 11}, scene.scans,
                         drive_.path());
  }

  RunSummary run_with(PipelineConfig config) const {
    const Dataset dataset = open_dataset(drive_.path(), {});
    config.sensor = dataset.sensor;
    const DetectionList boxes =
        read_detections({drive_.path() / "detections" / "noisy.csv"}, dataset.calibration);
    return run(dataset, boxes, config, {.out = results_.path()}, {}, {});
  }

  std::string result(const std::string& file) const { return test::read_bytes(results_.path() / file); }

  TrajectoryErrors errors_of(const std::string& file) const {
    const PoseList truth = read_trajectory(drive_.path() / "truth" / "poses_stamp.txt");
    const PoseList estimate = read_trajectory(results_.path() / file);
    const auto view = [](const PoseList& poses) {
      return TrajectoryView{poses.frames, poses.stamps_s, poses.T_world_body};
    };
    return trajectory_errors(match_poses(view(truth), view(estimate), MatchBy::frame));
  }

 private:
  test::TempFolder drive_;
  test::TempFolder results_;
};

TEST_P(ShortDrive, IsFollowedWithinItsCeilings) {
  const Case& scene = GetParam();
  const RunSummary summary = run_with({});
  EXPECT_EQ(summary.processed, scene.scans);
  EXPECT_EQ(summary.predicted, 0U);
  EXPECT_EQ(summary.degenerate + summary.odometry_degenerate == 0, scene.kind != SceneKind::tunnel)
      << summary.degenerate << ", odometry " << summary.odometry_degenerate;
  const TrajectoryErrors trajectory = errors_of("trajectory.txt");
  const TrajectoryErrors odometry = errors_of("odometry.txt");
  RecordProperty("trajectory_ate_m", std::to_string(*trajectory.ate_m));
  RecordProperty("trajectory_rte_m", std::to_string(*trajectory.rte_m_per_frame));
  RecordProperty("odometry_ate_m", std::to_string(*odometry.ate_m));
  EXPECT_LT(*trajectory.ate_m, scene.trajectory_ate_m);
  EXPECT_LT(*trajectory.rte_m_per_frame, scene.trajectory_rte_m);
  EXPECT_LT(*odometry.ate_m, scene.odometry_ate_m);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ShortDrive,
                         testing::Values(Case{SceneKind::city, 60.0, 60, 0.008, 0.0095, 0.07},
                                         Case{SceneKind::suburb, 60.0, 60, 0.0095, 0.011, 0.045},
                                         Case{SceneKind::highway, 200.0, 60, 0.027, 0.013, 0.075},
                                         Case{SceneKind::tunnel, 200.0, 110, 0.23, 0.021, 0.3},
                                         Case{SceneKind::train, 60.0, 90, 0.0065, 0.005, 0.08},
                                         Case{SceneKind::jam, 10.0, 60, 0.022, 0.006, 0.57},
                                         Case{SceneKind::parking, 60.0, 60, 0.006, 0.0075, 0.067}),
                         [](const auto& each) { return std::string(simulator::name_of(each.param.kind)); });

/// Plain least squares, as the paper has it, in place of the default's narrow robust kernel.
PipelineConfig without_kernel(bool consistency_check) {
  PipelineConfig config;
  config.odometry.kernel_m = 10.0;
  config.odometry.consistency_check = consistency_check;
  return config;
}

class BesideTheTrain : public ShortDrive {};

TEST_P(BesideTheTrain, LeastSquaresNeedTheConsistencyCheck) {
  run_with(without_kernel(true));
  const double with_check_m = *errors_of("odometry.txt").ate_m;
  run_with(without_kernel(false));
  const double without_m = *errors_of("odometry.txt").ate_m;
  EXPECT_LT(with_check_m, GetParam().odometry_ate_m);
  EXPECT_GT(without_m, 2.0 * with_check_m);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BesideTheTrain,
                         testing::Values(Case{SceneKind::train, 60.0, 90, 0.0, 0.0, 0.16}));

class AnyNumberOfThreads : public ShortDrive {};

TEST_P(AnyNumberOfThreads, TheSameBytes) {
  const std::vector<std::string> files = {"trajectory.txt", "objects.csv", "static_map.ply", "scene.mlo"};
  std::map<std::string, std::string> expected;
  for (const std::size_t threads : {1U, 2U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    run_with({});
    for (const std::string& file : files) {
      const std::string bytes = result(file);
      EXPECT_FALSE(bytes.empty()) << file;
      EXPECT_TRUE(expected.try_emplace(file, bytes).first->second == bytes)
          << file << ", " << threads << " threads";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, AnyNumberOfThreads,
                         testing::Values(Case{SceneKind::city, 15.0, 20, 0.0, 0.0, 0.0}));

}  // namespace
}  // namespace mlo
