#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/program.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "scene/small_scene.hpp"

namespace mlo {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Export : public testing::Test {
 protected:
  Export() { test::write_small_scene(scene_, 4); }

  /// Exports the small scene; returns the file that it wrote.
  std::filesystem::path run(const std::string& format, const std::vector<std::string>& more = {}) const {
    const std::filesystem::path out = folder_ / ("out." + format);
    std::vector<std::string> arguments{"export", scene_.string(), "--format", format, "--out", out.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr(out.string()));
    return out;
  }

  std::filesystem::path folder_ = fresh_folder();
  std::filesystem::path scene_ = folder_ / "scene.mlo";
};

TEST_F(Export, HelpEndsInExamples) {
  const ProgramRun help = run_program({"export", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("mcap"), HasSubstr("Examples:")));
}

TEST_F(Export, MapsReadBack) {
  for (const char* format : {"ply", "pcd"}) {
    EXPECT_EQ(read_map(run(format)).size(), test::small_map().size()) << format;
    EXPECT_EQ(read_map(run(format, {"--object", "3"})).size(), test::small_shape().points.size()) << format;
  }
}

TEST_F(Export, TrajectoriesReadBack) {
  EXPECT_EQ(read_trajectory(run("kitti")).T_world_body.size(), 4U);
  const PoseList poses = read_trajectory(run("tum", {"--object", "3"}));
  ASSERT_EQ(poses.stamps_s.size(), 4U);
  EXPECT_EQ(poses.T_world_body[2].translation().x(), 1.0);
}

TEST_F(Export, ObjectsReadBack) {
  EXPECT_EQ(read_objects_csv(run("csv")).size(), 4U);
}

TEST_F(Export, McapBeginsAndEndsWithItsMagic) {
  const std::string bytes = read_text(run("mcap"));
  EXPECT_EQ(bytes.substr(1, 4), "MCAP");
  EXPECT_EQ(bytes.substr(bytes.size() - 7, 4), "MCAP");
}

TEST_F(Export, WhatDoesNotFitIsTold) {
  const std::string out = (folder_ / "out").string();
  EXPECT_EQ(run_program({"export", scene_.string(), "--format", "xyz", "--out", out}).exit_code, 2);
  EXPECT_EQ(
      run_program({"export", scene_.string(), "--format", "csv", "--object", "3", "--out", out}).exit_code,
      2);
  const ProgramRun absent =
      run_program({"export", scene_.string(), "--format", "tum", "--object", "99", "--out", out});
  EXPECT_EQ(absent.exit_code, 1);
  EXPECT_THAT(absent.err, HasSubstr("no scan has an object 99"));
}

}  // namespace
}  // namespace mlo
