#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "apps/room.hpp"

namespace mlo {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

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
  EXPECT_THAT(run.out, AllOf(HasSubstr("3 of 3 scans"), HasSubstr("found by the detector 'cluster'")));
  for (const char* name : {"trajectory.txt", "trajectory_camera.txt", "trajectory_tum.txt", "odometry.txt",
                           "static_map.ply", "static_map.pcd", "run.json", "per_scan.csv", "config.yaml"}) {
    EXPECT_GT(std::filesystem::file_size(out / name), 0U) << name;
  }
  const nlohmann::json report = nlohmann::json::parse(read_text(out / "run.json"));
  EXPECT_EQ(report.at("predicted"), 0);
  EXPECT_LT(report.at("path_m"), 0.01);
}

TEST(Run, WithoutADetector) {
  const std::filesystem::path sequence = room_sequence();
  const std::filesystem::path out = sequence.parent_path() / "out";
  const ProgramRun run =
      run_program({"-q", "run", sequence.string(), "--out", out.string(), "--detector", "none"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("objects: none looked for"));
  EXPECT_FALSE(std::filesystem::exists(out / "objects.csv"));
  const ProgramRun both = run_program(
      {"run", sequence.string(), "--out", out.string(), "--detector", "none", "--detections", "boxes.csv"});
  EXPECT_EQ(both.exit_code, 2);
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
