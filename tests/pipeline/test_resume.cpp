#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file_bytes.hpp"
#include "io/synthetic_sweep.hpp"
#include "mlo/core/archive.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/pipeline/object_table.hpp"
#include "mlo/pipeline/pipeline.hpp"
#include "mlo/pipeline/run.hpp"
#include "pipeline/run_folders.hpp"
#include "pipeline/street.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::HasSubstr;

constexpr std::size_t kResumedScans = 12;

PipelineConfig small_memory_config() {
  PipelineConfig config = test::street_config();
  config.mapping.static_map.memory_radius_m = 50.0;
  return config;
}

FrameResult process(Pipeline& pipeline, std::size_t i) {
  const auto sweeps = static_cast<double>(i);
  return pipeline.process(test::street_scan(i, sweeps, false),
                          std::vector<Detection>{test::parked_car(sweeps)});
}

/// All that a scan brought, with every digit.
std::string text_of(const FrameResult& result) {
  std::string text = kitti_row(result.T_map_lidar) + kitti_row(result.T_odom_lidar) +
                     fmt::format("{} {} {}", result.refinement.num_matches, result.refinement.rms_residual_m,
                                 result.refinement.covariance.norm());
  for (const TrackedObject& object : result.objects) {
    text +=
        fmt::format("{} {} {} ", object_table_row({}, object), object.existence, object.moving_probability) +
        kitti_row(object.T_map_object);
  }
  return text;
}

std::string bytes_of(const Pipeline& pipeline) {
  ArchiveWriter writer;
  writer(pipeline);
  return writer.take();
}

std::string map_of(const Pipeline& pipeline) {
  ArchiveWriter writer;
  writer(pipeline.static_map().points());
  return writer.take();
}

// Right at the beginning too, when the motion of the first scan is not known yet.
TEST(PipelineState, APipelineThatReadsItGoesOnAsTheOtherWould) {
  for (const std::size_t before : {0U, 1U, 2U, 6U}) {
    Pipeline pipeline(small_memory_config());
    for (std::size_t i = 0; i < before; ++i) process(pipeline, i);
    const std::string state = bytes_of(pipeline);
    Pipeline other(small_memory_config());
    ArchiveReader reader(state, "state");
    reader(other);
    EXPECT_TRUE(reader.at_end());
    for (std::size_t i = before; i < kResumedScans; ++i) {
      EXPECT_EQ(text_of(process(other, i)), text_of(process(pipeline, i))) << before << " " << i;
    }
    EXPECT_TRUE(map_of(other) == map_of(pipeline)) << before;
  }
}

TEST(PipelineState, DamagedBytesAreAnInputError) {
  Pipeline pipeline(small_memory_config());
  for (std::size_t i = 0; i < 3; ++i) process(pipeline, i);
  const std::string state = bytes_of(pipeline);
  Pipeline other(small_memory_config());
  ArchiveReader reader(std::string_view(state).substr(0, state.size() - 1), "state");
  EXPECT_THROW(reader(other), InputError);
}

/// Thrown in the middle of a run, which then leaves what a killed one leaves.
struct Killed {};

class Resume : public testing::Test {
 protected:
  Resume() {
    for (std::size_t i = 0; i < kResumedScans; ++i) {
      if (i == 4) continue;  // a scan that is missing
      folder_.write(fmt::format("scans/{:06}.bin", i),
                    test::to_bin(test::street_scan(i, static_cast<double>(i), false).points));
      DetectionRecord record;
      record.detection = test::parked_car(static_cast<double>(i));
      detections_.by_frame[i].push_back(record);
    }
  }

  Dataset dataset() const { return open_dataset(folder_.path() / "scans", {.sensor = test::small_lidar()}); }
  std::filesystem::path out(const char* name) const { return folder_.path() / name; }
  RunOptions options(const char* name, bool resume = false) const {
    return {.out = out(name), .checkpoint_scans = 5, .state_scans = 3, .resume = resume};
  }
  RunSummary run_whole(const RunOptions& options,
                       const PipelineConfig& config = small_memory_config()) const {
    return run(dataset(), detections_, config, options, {}, {});
  }
  void run_and_kill(const char* name, std::size_t after, bool resume = false) const {
    const auto kill = [&](std::size_t done, std::size_t) {
      if (done == after) throw Killed{};
    };
    EXPECT_THROW(run(dataset(), detections_, small_memory_config(), options(name, resume), kill, {}), Killed);
  }
  void expect_same_results(const char* a, const char* b) const {
    EXPECT_THAT(test::result_files(out(a)),
                testing::IsSupersetOf({"objects.csv", "scene.mlo", "static_map.ply"}));
    EXPECT_THAT(test::different_results(out(a), out(b)), testing::IsEmpty());
  }

  test::TempFolder folder_;
  DetectionList detections_;
};

TEST_F(Resume, AKilledRunEndsAsOneThatWasNeverStopped) {
  const RunSummary whole = run_whole(options("whole"));
  for (const std::size_t after : {1U, 3U, 5U, 11U}) {  // before the first state, at one, between, at the end
    run_and_kill("killed", after);
    const RunSummary summary = run_whole(options("killed", true));
    EXPECT_EQ(summary.processed, whole.processed);
    EXPECT_EQ(summary.skipped, whole.skipped);
    EXPECT_EQ(summary.warnings, whole.warnings);
    EXPECT_EQ(summary.path_m, whole.path_m);
    EXPECT_EQ(summary.times.size(), whole.times.size());
    expect_same_results("whole", "killed");
  }
}

TEST_F(Resume, KilledAgainAndAgain) {
  run_whole(options("whole"));
  run_and_kill("killed", 4);
  run_and_kill("killed", 5, true);
  run_and_kill("killed", 8, true);
  run_whole(options("killed", true));
  expect_same_results("whole", "killed");
}

TEST_F(Resume, AnInterruptedRunGoesOnWhereItWas) {
  run_whole(options("whole"));
  std::size_t done = 0;
  const auto count = [&](std::size_t n, std::size_t) { done = n; };
  EXPECT_TRUE(run(dataset(), detections_, small_memory_config(), options("stopped"), count, [&] {
                return done == 5;
              }).interrupted);
  std::size_t first = 0;
  const auto remember_first = [&](std::size_t n, std::size_t) {
    if (first == 0) first = n;
  };
  run(dataset(), detections_, small_memory_config(), options("stopped", true), remember_first, {});
  EXPECT_EQ(first, 6U);
  expect_same_results("whole", "stopped");
}

TEST_F(Resume, WithoutAStateItBeginsAnew) {
  run_whole(options("whole"));
  run_whole(options("new", true));
  expect_same_results("whole", "new");
}

TEST_F(Resume, AnotherConfigurationIsAnInputErrorThatNamesTheDifference) {
  run_and_kill("killed", 6);
  PipelineConfig other = small_memory_config();
  other.mapping.refinement.gate_m = 0.7;
  try {
    run_whole(options("killed", true), other);
    FAIL() << "it went on";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("gate_m: 0.8"), HasSubstr("gate_m: 0.7"),
                                             HasSubstr("without --resume")));
  }
}

TEST_F(Resume, ADamagedStateIsAnInputErrorWithARemedy) {
  run_and_kill("killed", 6);
  std::string bytes = test::read_bytes(out("killed") / "state.bin");
  for (const std::size_t size : {bytes.size() / 2, std::size_t{4}}) {
    folder_.write("killed/state.bin", bytes.substr(0, size));
    EXPECT_THROW(run_whole(options("killed", true)), InputError);
  }
  bytes[bytes.size() - 10] ^= 1;
  folder_.write("killed/state.bin", bytes);
  EXPECT_THROW(run_whole(options("killed", true)), InputError);
}

}  // namespace
}  // namespace mlo
