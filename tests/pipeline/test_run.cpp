#include <algorithm>
#include <limits>
#include <memory>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

#include "io/file_bytes.hpp"
#include "io/synthetic_sweep.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/pipeline/run.hpp"
#include "mlo/scene/scene_file.hpp"
#include "pipeline/street.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr std::size_t kEmpty = 2;
constexpr std::size_t kTruncated = 4;
constexpr std::size_t kNaN = 5;
constexpr std::size_t kMissing = 7;
constexpr std::size_t kRunScans = 10;

std::string file_name(std::size_t frame) {
  return "scans/00000" + std::to_string(frame) + ".bin";
}

std::string scan_bytes(std::size_t frame) {
  return test::to_bin(test::street_scan(frame, static_cast<double>(frame), false).points);
}

std::string nan_bytes() {
  std::vector<Point> points(100);
  for (Point& p : points) p.p_lidar.setConstant(std::numeric_limits<float>::quiet_NaN());
  return test::to_bin(points);
}

void write_good_scans(const test::TempFolder& folder, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) folder.write(file_name(i), scan_bytes(i));
}

/// Ten scans of which one is empty, one cut off, one NaN throughout and one absent.
void write_bad_sequence(const test::TempFolder& folder) {
  write_good_scans(folder, kRunScans);
  folder.write(file_name(kEmpty), "");
  folder.write(file_name(kTruncated), scan_bytes(kTruncated).substr(0, 5003));
  folder.write(file_name(kNaN), nan_bytes());
  std::filesystem::remove(folder.path() / file_name(kMissing));
}

PipelineConfig small_config() {
  PipelineConfig config;
  config.sensor = test::small_lidar();
  return config;
}

Dataset open(const test::TempFolder& folder) {
  return open_dataset(folder.path() / "scans", {.sensor = test::small_lidar()});
}

RunSummary run_all(const Dataset& dataset, const RunOptions& options) {
  return run(dataset, std::nullopt, small_config(), options, {}, {});
}

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::istringstream text(test::read_bytes(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// Columns of a CSV row; commas within quotes do not count.
std::size_t num_columns(const std::string& row) {
  bool quoted = false;
  std::size_t count = 1;
  for (const char c : row) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) ++count;
  }
  return count;
}

std::string message_of(const Dataset& dataset, const RunOptions& options) {
  try {
    run_all(dataset, options);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "the run went through";
  return {};
}

/// One run over the bad sequence for all tests that look at its results.
class BadSequence : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempFolder>();
    write_bad_sequence(*folder_);
    summary_ = run_all(open(*folder_), {.out = out(), .checkpoint_scans = 3});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::filesystem::path out() { return folder_->path() / "results" / "bad"; }

  static std::unique_ptr<test::TempFolder> folder_;
  static RunSummary summary_;
};
std::unique_ptr<test::TempFolder> BadSequence::folder_;
RunSummary BadSequence::summary_;

TEST_F(BadSequence, IsCountedAndNamed) {
  EXPECT_EQ(summary_.scans, kRunScans);
  EXPECT_EQ(summary_.processed, kRunScans - 4);
  EXPECT_EQ(summary_.skipped, 4U);
  EXPECT_EQ(summary_.invalid_points, 100U);
  EXPECT_EQ(summary_.predicted, 0U);
  EXPECT_EQ(summary_.times.size(), summary_.processed);
  EXPECT_FALSE(summary_.interrupted);
  EXPECT_NEAR(summary_.path_m, 0.6 * 9, 0.15);
  for (const std::size_t frame : {kEmpty, kTruncated, kNaN, kMissing}) {
    EXPECT_THAT(summary_.warnings, Contains(AllOf(HasSubstr("scan " + std::to_string(frame) + " was skipped"),
                                                  HasSubstr("00000" + std::to_string(frame) + ".bin"))));
  }
}

TEST_F(BadSequence, HasAPoseForEveryFrame) {
  for (const char* name : {"trajectory.txt", "odometry.txt"}) {
    EXPECT_EQ(read_trajectory(out() / name).T_world_body.size(), kRunScans) << name;
  }
  EXPECT_EQ(read_trajectory(out() / "trajectory_tum.txt").stamps_s.size(), kRunScans - 4);
  const PoseList poses = read_trajectory(out() / "trajectory.txt");
  for (std::size_t i = 0; i < kRunScans; ++i) {
    const SE3 truth = test::street_pose(0.0).inverse() * test::street_pose(static_cast<double>(i));
    // The first motion is unknown until the second scan, all others are found or predicted from it.
    EXPECT_LT((truth.inverse() * poses.T_world_body[i]).translation().norm(), 0.1) << i;
  }
}

TEST_F(BadSequence, TableHasARowOfEqualLengthForEveryFrame) {
  const std::vector<std::string> lines = lines_of(out() / "per_scan.csv");
  ASSERT_EQ(lines.size(), 1 + kRunScans);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(num_columns(lines[i]), num_columns(lines[0])) << lines[i];
    if (i > 0) {
      EXPECT_EQ(lines[i].substr(0, lines[i].find(',')), std::to_string(i - 1));
    }
  }
  EXPECT_THAT(lines[1 + kEmpty], AllOf(HasSubstr("skipped"), HasSubstr("no valid point")));
  EXPECT_THAT(lines[1], HasSubstr(",first,"));
  EXPECT_THAT(lines[kRunScans], HasSubstr(",localised,"));
}

TEST_F(BadSequence, ReportIsJsonWithTheSameNumbers) {
  const nlohmann::json report = nlohmann::json::parse(test::read_bytes(out() / "run.json"));
  EXPECT_EQ(report.at("scans"), summary_.scans);
  EXPECT_EQ(report.at("processed"), summary_.processed);
  EXPECT_EQ(report.at("skipped"), summary_.skipped);
  EXPECT_EQ(report.at("predicted"), summary_.predicted);
  EXPECT_EQ(report.at("static_map_points"), summary_.map_points);
  EXPECT_EQ(report.at("warnings").size(), summary_.warnings.size());
  EXPECT_EQ(report.at("interrupted"), false);
  EXPECT_GT(report.at("times").at("scan").at("mean_ms"), 0.0);
  EXPECT_GT(summary_.map_points, 1000U);
}

TEST_F(BadSequence, ConfigurationReadsBackTheSame) {
  const PipelineConfig config = resolve({.file = out() / "config.yaml"});
  EXPECT_EQ(to_yaml(config), to_yaml(small_config()));
}

TEST_F(BadSequence, SceneHasEveryFrameAndTheMap) {
  const SceneFile scene(out() / "scene.mlo");
  EXPECT_TRUE(scene.complete());
  ASSERT_EQ(scene.num_scans(), kRunScans);
  const PoseList poses = read_trajectory(out() / "trajectory.txt");
  for (std::size_t i = 0; i < kRunScans; ++i) {
    const SceneScan scan = scene.scan(i);
    EXPECT_EQ(scan.frame, i);
    EXPECT_NEAR(scan.stamp_s, 0.1 * static_cast<double>(i), 1e-6);
    EXPECT_EQ(scan.status == ScanStatus::skipped, !scan.problem.empty());
    EXPECT_TRUE(scan.T_map_lidar.matrix().isApprox(poses.T_world_body[i].matrix(), 1e-6));
  }
  EXPECT_EQ(scene.scan(kMissing).status, ScanStatus::skipped);
  EXPECT_EQ(scene.map().size(), summary_.map_points);
}

TEST(Run, InterruptedKeepsWhatWasDone) {
  const test::TempFolder folder;
  write_good_scans(folder, 5);
  const std::filesystem::path out = folder.path() / "out";
  std::size_t done = 0;
  const RunSummary summary = run(
      open(folder), std::nullopt, small_config(), {.out = out}, [&](std::size_t n, std::size_t) { done = n; },
      [&] { return done == 3; });
  EXPECT_TRUE(summary.interrupted);
  EXPECT_EQ(summary.processed, 3U);
  EXPECT_EQ(read_trajectory(out / "trajectory.txt").T_world_body.size(), 3U);
  EXPECT_EQ(lines_of(out / "per_scan.csv").size(), 4U);
  EXPECT_EQ(nlohmann::json::parse(test::read_bytes(out / "run.json")).at("interrupted"), true);
  EXPECT_TRUE(std::filesystem::exists(out / "static_map.ply"));
  EXPECT_TRUE(std::filesystem::exists(out / "static_map.pcd"));
}

TEST(Run, InterruptedBeforeTheFirstScanStillWritesValidFiles) {
  const test::TempFolder folder;
  write_good_scans(folder, 2);
  const std::filesystem::path out = folder.path() / "out";
  const RunSummary summary =
      run(open(folder), std::nullopt, small_config(), {.out = out}, {}, [] { return true; });
  EXPECT_TRUE(summary.interrupted);
  EXPECT_EQ(nlohmann::json::parse(test::read_bytes(out / "run.json")).at("processed"), 0);
}

TEST(Run, OnlyTheFramesAskedFor) {
  const test::TempFolder folder;
  write_good_scans(folder, 4);
  const std::filesystem::path out = folder.path() / "out";
  const RunSummary summary =
      run_all(open(folder), {.out = out, .first_frame = 1, .last_frame = 2, .checkpoint_scans = 0});
  EXPECT_EQ(summary.scans, 2U);
  EXPECT_THAT(lines_of(out / "per_scan.csv").at(1), testing::StartsWith("1,"));
  EXPECT_THAT(message_of(open(folder), {.out = out, .first_frame = 9, .last_frame = 12}),
              AllOf(HasSubstr("frames asked for"), HasSubstr("9 to 12")));
}

TEST(Run, AnOutputFolderThatCannotBeMadeIsAnInputError) {
  const test::TempFolder folder;
  write_good_scans(folder, 1);
  const std::filesystem::path file = folder.write("file", "in the way");
  EXPECT_THAT(message_of(open(folder), {.out = file}), AllOf(HasSubstr(file.string()), HasSubstr("--out")));
  EXPECT_THAT(message_of(open(folder), {.out = file / "out"}), HasSubstr("--out"));
}

TEST(Run, WithoutAnyUsableScanTheFirstProblemIsTold) {
  const test::TempFolder folder;
  folder.write(file_name(0), "");
  folder.write(file_name(1), "123");
  EXPECT_THAT(message_of(open(folder), {.out = folder.path() / "out"}),
              AllOf(HasSubstr("none of the 2 scans"), HasSubstr("000000.bin: no valid point")));
}

TEST(Run, OneAndTwoThreadsWriteTheSameBytes) {
  const test::TempFolder folder;
  write_good_scans(folder, 5);
  std::vector<std::string> trajectories;
  std::vector<std::string> maps;
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const std::filesystem::path out = folder.path() / ("out" + std::to_string(threads));
    run_all(open(folder), {.out = out});
    trajectories.push_back(test::read_bytes(out / "trajectory.txt"));
    maps.push_back(test::read_bytes(out / "static_map.ply"));
  }
  EXPECT_GT(maps[0].size(), 10000U);
  EXPECT_TRUE(trajectories[0] == trajectories[1]);
  EXPECT_TRUE(maps[0] == maps[1]);
}

TEST(Run, DetectionsAreCountedAndCutOut) {
  const test::TempFolder folder;
  write_good_scans(folder, 4);
  DetectionList detections;
  for (std::size_t i = 0; i < 4; ++i) {
    DetectionRecord record;
    record.detection = test::parked_car(static_cast<double>(i));
    detections.by_frame[i].push_back(record);
  }
  const std::filesystem::path out = folder.path() / "out";
  const RunSummary summary = run(open(folder), detections, small_config(), {.out = out}, {}, {});
  EXPECT_EQ(summary.detections, 4U);
  const nlohmann::json report = nlohmann::json::parse(test::read_bytes(out / "run.json"));
  EXPECT_EQ(report.at("detections"), 4);
  EXPECT_TRUE(std::filesystem::exists(out / "objects.csv"));
  EXPECT_TRUE(std::filesystem::exists(out / "object_trajectories"));
}

TEST(Run, SaysWhatFoundTheBoxes) {
  const test::TempFolder folder;
  write_good_scans(folder, 3);
  const auto run_with = [&](const std::string& detector) {
    PipelineConfig config = small_config();
    config.detection.detector = detector == "none" ? Detector::none : Detector::cluster;
    config.detection.cluster.min_probability = 0.0;  // all that it judges
    config.detection.cluster.min_candidate = 0.0;
    return run(open(folder), std::nullopt, config, {.out = folder.path() / detector}, {}, {});
  };
  const RunSummary without = run_with("none");
  EXPECT_EQ(without.boxes_from, "none");
  EXPECT_EQ(without.detections, 0U);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "none" / "objects.csv"));
  const RunSummary with = run_with("cluster");
  EXPECT_EQ(with.boxes_from, "cluster");
  EXPECT_GT(with.detections, 0U);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "cluster" / "objects.csv"));
  const auto report = nlohmann::json::parse(test::read_bytes(folder.path() / "cluster" / "run.json"));
  EXPECT_EQ(report.at("boxes_from"), "cluster");
  const RunSummary given =
      run(open(folder), DetectionList{}, small_config(), {.out = folder.path() / "given"}, {}, {});
  EXPECT_EQ(given.boxes_from, "given");
}

}  // namespace
}  // namespace mlo
