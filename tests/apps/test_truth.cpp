#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::HasSubstr;

TEST(Truth, RecoversTheTruthOfASimulatedDrive) {
  const std::string folder = fresh_folder().string();
  const std::string city = folder + "/city";
  const ProgramRun simulation =
      run_program({"-q", "simulate", "--scene", "city", "--scans", "25", "--seed", "3", "--out", city});
  if (simulation.exit_code == 2) GTEST_SKIP() << "the program was built without the simulator";
  ASSERT_EQ(simulation.exit_code, 0) << simulation.err;
  const ProgramRun truth = run_program({"truth", city, "--out", folder + "/truth", "--check"});
  ASSERT_EQ(truth.exit_code, 0) << truth.err;
  EXPECT_THAT(truth.out, testing::AllOf(HasSubstr("25 poses"), HasSubstr("smoothed")));

  const ProgramRun poses = run_program({"eval", "trajectory", "--truth", city + "/truth/poses_stamp.txt",
                                        "--estimate", folder + "/truth/poses.txt", "--json"});
  const auto errors = nlohmann::json::parse(poses.out)["estimates"][0];
  EXPECT_EQ(errors["pairs"].get<int>(), 25);
  EXPECT_LT(errors["ate_m"].get<double>(), 0.01);
  EXPECT_LT(errors["rre_deg_per_frame"].get<double>(), 0.05);

  // Objects of the labels, in the camera's view, against those of the simulator, all round.
  const ProgramRun objects = run_program({"eval", "objects", "--truth", folder + "/truth/objects.csv",
                                          "--estimate", city + "/truth/objects.csv", "--json"});
  ASSERT_EQ(objects.exit_code, 0) << objects.err;
  const auto all = nlohmann::json::parse(objects.out)["all"];
  EXPECT_GT(all["objects"].get<int>(), 0);
  EXPECT_EQ(all["lost"].get<int>(), 0);
  EXPECT_EQ(all["missed_frames"].get<int>(), 0);
  EXPECT_LT(all["position_rmse_m"].get<double>(), 0.05);
}

TEST(Truth, NeedsRecords) {
  const test::TempFolder folder;
  folder.write("scans/000000.bin", std::string(64, '\0'));
  const ProgramRun run =
      run_program({"truth", (folder.path() / "scans").string(), "--out", (folder.path() / "out").string()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("calibration"));
}

}  // namespace
}  // namespace mlo
