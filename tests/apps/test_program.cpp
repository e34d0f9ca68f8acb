#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/program.hpp"

namespace mlo {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// The names below "Subcommands:" in the program's help.
std::vector<std::string> subcommands() {
  std::istringstream help(run_program({"--help"}).out);
  std::vector<std::string> names;
  bool inside = false;
  for (std::string line; std::getline(help, line);) {
    if (inside && line.empty()) break;
    if (inside && line.size() > 2 && line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
    inside = inside || line == "Subcommands:";
  }
  return names;
}

TEST(Program, HelpNamesExitCodesAndExamples) {
  const ProgramRun run = run_program({"--help"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, AllOf(HasSubstr("Usage: mlo"), HasSubstr("Exit codes:"), HasSubstr("Examples:")));
  EXPECT_THAT(run.err, IsEmpty());
}

TEST(Program, EverySubcommandHasHelpWithExamples) {
  const std::vector<std::string> names = subcommands();
  ASSERT_THAT(names, testing::Contains("config"));
  for (const std::string& name : names) {
    const ProgramRun run = run_program({name, "--help"});
    EXPECT_EQ(run.exit_code, 0) << name;
    EXPECT_THAT(run.out, AllOf(HasSubstr("Usage: mlo " + name), HasSubstr("Examples:\n  mlo " + name)));
  }
}

TEST(Program, VersionIsPrinted) {
  const ProgramRun run = run_program({"--version"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(Program, WrongUsageEndsWithTwoAndPointsToHelp) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {}, {"--nope"}, {"config", "--nope"}, {"config", "extra"}, {"config", "--quiet", "--verbose"}}) {
    const ProgramRun run = run_program(arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, AllOf(StartsWith("mlo: "), HasSubstr("--help")));
    EXPECT_THAT(run.out, IsEmpty());
  }
}

TEST(Program, UnknownSubcommandsSuggestTheNearest) {
  const ProgramRun near = run_program({"cofnig"});
  EXPECT_EQ(near.exit_code, 2);
  EXPECT_THAT(near.err, HasSubstr("no subcommand 'cofnig'; did you mean 'config'?"));
  const ProgramRun far = run_program({"xylophone"});
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_THAT(far.err, AllOf(HasSubstr("no subcommand 'xylophone'"), Not(HasSubstr("did you mean"))));
}

TEST(Config, OutputReadBackIsTheSame) {
  const auto folder = fresh_folder();
  const std::string file = (folder / "config.yaml").string();
  const ProgramRun first =
      run_program({"config", "--preset", "generic,vlp16", "--set", "sensor.max_range_m=80"});
  ASSERT_EQ(first.exit_code, 0);
  EXPECT_THAT(first.out, AllOf(HasSubstr("name: \"VLP-16\""), HasSubstr("max_range_m: 80.0")));
  const ProgramRun written = run_program({"config", "--preset", "generic", "--preset", "vlp16", "--set",
                                          "sensor.max_range_m=80", "--out", file});
  ASSERT_EQ(written.exit_code, 0);
  EXPECT_THAT(written.out, IsEmpty());
  EXPECT_EQ(read_text(file), first.out);
  const ProgramRun second = run_program({"config", "--config", file});
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_EQ(second.out, first.out);
}

TEST(Config, MistakesEndWithOneAndAreExplained) {
  const auto folder = fresh_folder();
  const std::string file = (folder / "bad.yaml").string();
  std::ofstream(file) << "sensor:\n  max_rnge_m: 80\n";
  const ProgramRun unknown = run_program({"config", "--config", file});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.out, IsEmpty());
  EXPECT_THAT(unknown.err, AllOf(StartsWith("error: "), HasSubstr(file + ":2:"),
                                 HasSubstr("did you mean 'sensor.max_range_m'?")));

  EXPECT_EQ(run_program({"config", "--config", (folder / "none.yaml").string()}).exit_code, 1);
  EXPECT_EQ(run_program({"config", "--preset", "nothing"}).exit_code, 1);
  EXPECT_EQ(run_program({"config", "--set", "sensor.rings=-1"}).exit_code, 1);
  EXPECT_EQ(run_program({"config", "--out", (folder / "none" / "out.yaml").string()}).exit_code, 1);
}

TEST(Config, ListsPresets) {
  const ProgramRun run = run_program({"config", "--list-presets"});
  EXPECT_EQ(run.exit_code, 0);
  for (const char* const name : {"generic", "hdl32e", "hdl64e", "os1-128", "os1-64", "pandar64", "vlp16"}) {
    EXPECT_THAT(run.out, HasSubstr(name));
  }
}

}  // namespace
}  // namespace mlo
