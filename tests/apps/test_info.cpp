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

/// A folder with two good scans and an empty one between them.
std::filesystem::path sequence_folder() {
  const std::filesystem::path velodyne = fresh_folder() / "04" / "velodyne";
  std::filesystem::create_directories(velodyne);
  const std::string scan = test::to_bin(test::make_sweep({.sensor = hdl64e(), .columns = 60}));
  std::ofstream(velodyne / "000000.bin", std::ios::binary) << scan;
  std::ofstream(velodyne / "000001.bin", std::ios::binary);
  std::ofstream(velodyne / "000002.bin", std::ios::binary) << scan;
  std::ofstream(velodyne.parent_path() / "times.txt") << "0.0\n0.1\n0.2\n";
  return velodyne.parent_path();
}

TEST(Info, SaysWhatIsThereAndWhatLooksWrong) {
  const ProgramRun run = run_program({"info", sequence_folder().string()});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, AllOf(HasSubstr("kitti_odometry, sequence 04"), HasSubstr("10.000 scans/s"),
                             HasSubstr("64 ... 64 ... 64"), HasSubstr("000001.bin: no valid point")));
  EXPECT_THAT(run.err, IsEmpty());
}

TEST(Info, JsonHoldsTheSame) {
  const ProgramRun run = run_program({"info", sequence_folder().string(), "--json", "--all"});
  const nlohmann::json json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json.at("scans"), 3);
  EXPECT_EQ(json.at("scans_unreadable"), 1);
  EXPECT_EQ(json.at("rings").at("median"), 64.0);
  EXPECT_EQ(json.at("findings").size(), 1U);
  EXPECT_TRUE(json.at("detections").is_null());
}

TEST(Info, AFolderWithoutScansIsAnInputError) {
  const ProgramRun run = run_program({"info", fresh_folder().string()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_THAT(run.err, AllOf(HasSubstr("no scans found"), HasSubstr("kitti_tracking")));
}

}  // namespace
}  // namespace mlo
