#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "scene/small_scene.hpp"

namespace mlo {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string small_scene_file() {
  const std::filesystem::path path = fresh_folder() / "scene.mlo";
  test::write_small_scene(path, 4);
  return path.string();
}

TEST(Scene, HelpEndsInExamples) {
  const ProgramRun run = run_program({"scene", "--help"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, AllOf(HasSubstr("--time"), HasSubstr("Examples:")));
}

TEST(Scene, SummaryAsTextAndAsJson) {
  const std::string file = small_scene_file();
  EXPECT_THAT(run_program({"scene", file}).out, AllOf(HasSubstr("4 localised"), HasSubstr("1 van")));
  const nlohmann::json summary = nlohmann::json::parse(run_program({"scene", file, "--json"}).out);
  EXPECT_EQ(summary.at("scans"), 4);
  EXPECT_EQ(summary.at("complete"), true);
  EXPECT_EQ(summary.at("objects").at("van"), 1);
}

TEST(Scene, StateAtATimeAsTextAndAsJson) {
  const std::string file = small_scene_file();
  EXPECT_THAT(run_program({"scene", file, "--time", "100.1"}).out,
              AllOf(HasSubstr("nearest scan 11"), HasSubstr("3 van: x 0.50 y 4.00")));
  const nlohmann::json state =
      nlohmann::json::parse(run_program({"scene", file, "--time", "100.15", "--json"}).out);
  EXPECT_NEAR(state.at("objects").at(0).at("T_map_object").at("position_m").at(0), 0.75, 1e-9);
}

TEST(Scene, ATimeOutsideIsAnInputError) {
  const ProgramRun run = run_program({"scene", small_scene_file(), "--time", "7"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("not within the scene"));
}

TEST(Scene, AnotherFileIsAnInputError) {
  const ProgramRun run = run_program({"scene", MLO_PROGRAM});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("no scene file"));
}

}  // namespace
}  // namespace mlo
