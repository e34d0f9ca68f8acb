#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>

namespace mlo {

/// What a run of the program mlo left behind.
struct ProgramRun {
  int exit_code = -1;
  std::string out;
  std::string err;
};

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A folder for the current test alone, empty at its start.
inline std::filesystem::path fresh_folder() {
  const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
  auto folder = std::filesystem::path(testing::TempDir()) /
                (std::string("mlo_") + test->test_suite_name() + "_" + test->name());
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

/// Runs the built program with these arguments, through the shell, as a user would.
inline ProgramRun run_program(const std::vector<std::string>& arguments) {
  const auto folder = std::filesystem::path(testing::TempDir());
  const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
  const std::string stem = (folder / (std::string(test->test_suite_name()) + "_" + test->name())).string();
  std::string command = MLO_PROGRAM;
  for (const std::string& argument : arguments) command += " '" + argument + "'";
  command += " > '" + stem + ".out' 2> '" + stem + ".err'";
  const int status = std::system(command.c_str());
  ProgramRun run;
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  run.out = read_text(stem + ".out");
  run.err = read_text(stem + ".err");
  std::filesystem::remove(stem + ".out");
  std::filesystem::remove(stem + ".err");
  return run;
}

}  // namespace mlo
