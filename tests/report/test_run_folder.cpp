#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/report/run_folder.hpp"
#include "report/run_files.hpp"

namespace mlo {
namespace {

using test::TempFolder;

TEST(RunFolder, ReadsWhatARunWrote) {
  const TempFolder folder;
  const auto path = test::write_run(folder, "a");
  folder.write("a/objects.csv", "frame,id,class,x_m,y_m,z_m,qx,qy,qz,qw\n0,1,car,5,5,0,0,0,0,1\n");
  const RunFolder run = read_run_folder(path);
  EXPECT_EQ(run.name, "a");
  EXPECT_EQ(run.input_sequence, "04");
  EXPECT_EQ(run.boxes_from, "cluster");
  EXPECT_THAT(run.counters, testing::Contains(testing::Pair("skipped", 1.0)));
  EXPECT_THAT(run.warnings, testing::ElementsAre("something <odd> & strange"));
  EXPECT_THAT(run.problems, testing::ElementsAre("frame 1: 000001.bin: 3 bytes, not whole"));
  ASSERT_EQ(run.stages.size(), 1U);
  EXPECT_EQ(run.stages[0].name, "perception");
  EXPECT_EQ(run.stages[0].p99_ms, 12.0);
  ASSERT_EQ(run.stages[0].ms.size(), 3U);
  EXPECT_EQ(run.stages[0].ms[0], 9.5);
  EXPECT_TRUE(std::isnan(run.stages[0].ms[1]));
  EXPECT_EQ(run.whole_scan.mean_ms, 20.0);
  EXPECT_EQ(run.trajectory.T_world_body.size(), 3U);
  EXPECT_EQ(run.map.size(), 400U);
  EXPECT_EQ(run.objects.size(), 1U);
  EXPECT_EQ(read_run_folder(path / "").name, "a");
}

TEST(RunFolder, MapAndObjectsMayBeMissing) {
  const TempFolder folder;
  const auto path = test::write_run(folder, "a");
  std::filesystem::remove(path / "static_map.ply");
  const RunFolder run = read_run_folder(path);
  EXPECT_TRUE(run.map.empty());
  EXPECT_TRUE(run.objects.empty());
}

TEST(RunFolder, WhatIsMissingOrBrokenIsNamed) {
  const TempFolder folder;
  const auto problem_of = [](const std::filesystem::path& path) {
    try {
      read_run_folder(path);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(problem_of(folder.path()), testing::HasSubstr("run.json"));
  const auto path = test::write_run(folder, "a");
  folder.write("a/run.json", "{\"version\": ");
  EXPECT_THAT(problem_of(path), testing::HasSubstr("no JSON"));
  test::write_run(folder, "a");
  std::filesystem::remove(path / "trajectory.txt");
  EXPECT_THAT(problem_of(path), testing::HasSubstr("trajectory.txt"));
}

}  // namespace
}  // namespace mlo
