#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/program.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Reproduce, AFolderWithoutKittiIsRefused) {
  const test::TempFolder folder;
  const ProgramRun run = run_program({"reproduce", folder.path().string()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, AllOf(HasSubstr("no KITTI data"), HasSubstr("velodyne_points")));
}

TEST(Reproduce, PrintsTheTableAndNamesWhatIsMissing) {
  const test::TempFolder folder;
  folder.write("tracking/training/velodyne/0001/000000.bin", std::string(32, '\0'));
  const ProgramRun run = run_program({"reproduce", folder.path().string(), "--out",
                                      (folder.path() / "out").string(), "--table", "Table IV"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("Table IV"), HasSubstr("0926-0032 15"), HasSubstr("missing: 13 of 13"),
                             testing::Not(HasSubstr("Table III"))));
}

}  // namespace
}  // namespace mlo
