#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "io/synthetic_sweep.hpp"

namespace mlo {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

/// KITTI odometry layout: a lidar that stands in a room for four scans.
std::filesystem::path room_sequence() {
  const std::filesystem::path sequence = fresh_folder() / "04";
  std::filesystem::create_directories(sequence / "velodyne");
  const std::string scan = test::to_bin(test::make_sweep({.sensor = hdl64e(), .columns = 300}));
  for (int i = 0; i < 4; ++i) {
    std::ofstream(sequence / "velodyne" / ("00000" + std::to_string(i) + ".bin"), std::ios::binary) << scan;
  }
  std::ofstream(sequence / "times.txt") << "0.0\n0.1\n0.2\n0.3\n";
  std::ofstream(sequence / "calib.txt") << "P0: 700 0 600 0 0 700 180 0 0 0 1 0\n"
                                        << "P1: 700 0 600 0 0 700 180 0 0 0 1 0\n"
                                        << "P2: 700 0 600 0 0 700 180 0 0 0 1 0\n"
                                        << "P3: 700 0 600 0 0 700 180 0 0 0 1 0\n"
                                        << "Tr: 0 -1 0 0 0 0 -1 -0.1 1 0 0 -0.3\n";
  return sequence;
}

TEST(Run, HelpEndsInExamples) {
  const ProgramRun run = run_program({"run", "--help"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, AllOf(HasSubstr("--frames"), HasSubstr("--detections"), HasSubstr("Examples:")));
  EXPECT_THAT(run.err, IsEmpty());
}

TEST(Run, FromScansToResults) {
  const std::filesystem::path sequence = room_sequence();
  const std::filesystem::path out = sequence.parent_path() / "out";
  const ProgramRun run = run_program({"-q", "run", sequence.string(), "--out", out.string(), "--threads", "1",
                                      "--frames", "1:3", "--set", "odometry.enabled=false"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("3 of 3 scans"));
  for (const char* name : {"trajectory.txt", "trajectory_camera.txt", "trajectory_tum.txt", "odometry.txt",
                           "static_map.ply", "static_map.pcd", "run.json", "per_scan.csv", "config.yaml"}) {
    EXPECT_GT(std::filesystem::file_size(out / name), 0U) << name;
  }
  const nlohmann::json report = nlohmann::json::parse(read_text(out / "run.json"));
  EXPECT_EQ(report.at("predicted"), 0);
  EXPECT_LT(report.at("path_m"), 0.01);
}

TEST(Run, AMissingFolderIsAnInputErrorWithARemedy) {
  const std::filesystem::path folder = fresh_folder();
  const ProgramRun run =
      run_program({"run", (folder / "absent").string(), "--out", (folder / "out").string()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_THAT(run.err, AllOf(HasSubstr((folder / "absent").string()),
                             HasSubstr("give the folder that holds the scans")));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(Run, FramesThatAreNoNumbersAreWrongUsage) {
  for (const char* frames : {"a:b", "3:x", "1:2:3", "-1", "5-9"}) {
    const ProgramRun run =
        run_program({"run", "somewhere", "--out", "out", std::string("--frames=") + frames});
    EXPECT_EQ(run.exit_code, 2) << frames;
    EXPECT_THAT(run.err, AllOf(HasSubstr("--frames"), HasSubstr("0:99"))) << frames;
  }
}

TEST(Run, FramesThatAreNotThereAreAnInputError) {
  const std::filesystem::path sequence = room_sequence();
  const ProgramRun run = run_program(
      {"run", sequence.string(), "--out", (sequence.parent_path() / "out").string(), "--frames", "50:"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("none of its 4 scans"));
}

}  // namespace
}  // namespace mlo
