#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/program.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;

/// Ten scans of a standing car, 20 m ahead.
std::string boxes() {
  std::string text = "frame,class,x_m,y_m,z_m,length_m,width_m,height_m,yaw_rad,score\n";
  for (int i = 0; i < 10; ++i) text += std::to_string(i) + ",car,20,2,-0.9,4.2,1.7,1.5,0.1,0.999\n";
  return text;
}

TEST(TrackProgram, TracksBoxesWithoutPosesAndCamera) {
  const TempFolder folder;
  const std::string detections = folder.write("boxes.csv", boxes()).string();
  const std::string out = (folder.path() / "out").string();
  const ProgramRun run = run_program({"track", "--detections", detections, "--out", out});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("1 sequences, 10 frames, 10 boxes"));
  EXPECT_THAT(read_text(out + "/objects/boxes.csv"),
              AllOf(HasSubstr("\n9,"), HasSubstr(",car,"), HasSubstr(",confirmed,")));
  EXPECT_TRUE(std::filesystem::exists(out + "/trajectories/boxes/00001.txt"));
  EXPECT_FALSE(std::filesystem::exists(out + "/tracks/boxes.txt")) << "there is no camera to show them in";
}

TEST(TrackProgram, SettingsAreRead) {
  const TempFolder folder;
  const std::string detections = folder.write("boxes.csv", boxes()).string();
  const std::string out = (folder.path() / "out").string();
  const ProgramRun run = run_program(
      {"track", "--detections", detections, "--out", out, "--set", "tracking.report.vehicle.bias=-50"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_FALSE(std::filesystem::exists(out + "/trajectories/boxes/00001.txt"));
}

TEST(TrackProgram, WhatIsMissingIsNamed) {
  const TempFolder folder;
  const std::string detections = folder.write("boxes.csv", boxes()).string();
  const std::string poses = folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n").string();
  const std::string out = (folder.path() / "out").string();
  ProgramRun run = run_program({"track", "--detections", detections, "--poses", poses, "--out", out});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("--calib"));
  run = run_program(
      {"track", "--detections", detections, "--poses", poses, "--poses-of", "lidar", "--out", out});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("frame 1"));
  const TempFolder empty;
  run = run_program({"track", "--detections", empty.path().string(), "--out", out});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("no .txt files"));
}

}  // namespace
}  // namespace mlo
