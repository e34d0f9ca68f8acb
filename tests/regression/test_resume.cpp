#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mlo/pipeline/run.hpp"
#include "pipeline/run_folders.hpp"
#include "regression/drive.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

constexpr std::size_t kScans = 24;

/// Thrown in the middle of a run, which then leaves what a killed one leaves.
struct Killed {};

/// A city with traffic, in which the cluster detector finds the objects; the map goes to disk early.
class ResumedDrive : public testing::Test {
 protected:
  ResumedDrive() {
    test::simulate_drive({.kind = simulator::SceneKind::city, .length_m = 60.0, .seed = 5}, kScans,
                         folder_.path() / "drive");
  }

  std::filesystem::path out(const std::string& name) const { return folder_.path() / name; }

  RunSummary run_on(const std::string& name, std::size_t threads, bool resume, std::size_t kill_after) const {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Dataset dataset = open_dataset(folder_.path() / "drive", {});
    PipelineConfig config;
    config.sensor = dataset.sensor;
    config.mapping.static_map.memory_radius_m = 30.0;
    const auto kill = [&](std::size_t done, std::size_t) {
      if (done == kill_after) throw Killed{};
    };
    return run(dataset, std::nullopt, config,
               {.out = out(name), .checkpoint_scans = 7, .state_scans = 4, .resume = resume}, kill, {});
  }

  test::TempFolder folder_;
};

TEST_F(ResumedDrive, EndsWithTheSameBytesForAnyNumberOfThreads) {
  constexpr std::size_t kNever = kScans + 1;
  const RunSummary whole = run_on("whole", 2, false, kNever);
  ASSERT_GT(whole.detections, kScans);
  ASSERT_THAT(test::result_files(out("whole")),
              testing::IsSupersetOf(
                  {"objects.csv", "scene.mlo", "static_map.ply", "trajectory.txt", "object_maps/00001.ply"}));
  std::size_t threads = 1;
  for (const std::size_t after : {2U, 4U, 5U, 13U, 23U}) {
    EXPECT_THROW(run_on("killed", threads, false, after), Killed);
    threads = 3 - threads;
    run_on("killed", threads, true, kNever);
    EXPECT_THAT(test::different_results(out("whole"), out("killed")), testing::IsEmpty()) << after;
  }
}

}  // namespace
}  // namespace mlo
