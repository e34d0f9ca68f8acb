#include <chrono>
#include <csignal>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include "apps/program.hpp"
#include "io/synthetic_sweep.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/scene/scene_file.hpp"
#include "pipeline/run_folders.hpp"
#include "pipeline/street.hpp"

extern char** environ;

namespace mlo {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::size_t kScans = 12;

/// A folder with scans of a street.
std::filesystem::path street_scans() {
  const std::filesystem::path folder = fresh_folder() / "scans";
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < kScans; ++i) {
    std::ofstream(folder / fmt::format("{:06}.bin", i), std::ios::binary)
        << test::to_bin(test::street_scan(i, static_cast<double>(i), false).points);
  }
  return folder;
}

std::uint64_t size_of(const std::filesystem::path& file) {
  std::error_code missing;
  const std::uint64_t size = std::filesystem::file_size(file, missing);
  return missing ? 0 : size;
}

std::vector<std::string> run_words(const std::filesystem::path& scans, const std::filesystem::path& out) {
  return {"-q", "run", scans.string(), "--out", out.string(), "--save-every", "3"};
}

/// Runs the program and kills it as soon as the scene file has so many bytes.
void run_and_kill(const std::filesystem::path& scans, const std::filesystem::path& out, std::uint64_t bytes) {
  std::vector<std::string> words = run_words(scans, out);
  words.insert(words.begin(), MLO_PROGRAM);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  ASSERT_EQ(posix_spawn(&child, MLO_PROGRAM, nullptr, nullptr, arguments.data(), environ), 0);
  int status = 0;
  while (size_of(out / "scene.mlo") < bytes && waitpid(child, &status, WNOHANG) == 0) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
}

/// All that the scene has must be whole, and as much as the text files have but for the scan that was being
/// written.
void expect_whole(const std::filesystem::path& out) {
  const SceneFile scene(out / "scene.mlo");
  const PoseList rows = read_trajectory(out / "trajectory.txt");
  EXPECT_GE(scene.num_scans() + 1, rows.T_world_body.size());
  EXPECT_LE(scene.num_scans(), kScans);
  for (std::size_t i = 0; i < std::min(scene.num_scans(), rows.T_world_body.size()); ++i) {
    EXPECT_TRUE(scene.scan(i).T_map_lidar.matrix().isApprox(rows.T_world_body[i].matrix(), 1e-6)) << i;
    EXPECT_GT(scene.cloud(i).points.size(), 100U);
  }
}

// The short form of scripts/kill_test.py.
TEST(KillSafety, AKilledRunLeavesASceneUpToTheLastFinishedScanAndGoesOnToTheSameBytes) {
  const std::filesystem::path scans = street_scans();
  const std::filesystem::path whole = scans.parent_path() / "whole";
  const std::filesystem::path out = scans.parent_path() / "out";
  ASSERT_EQ(run_program(run_words(scans, whole)).exit_code, 0);
  for (const double share : {0.02, 0.3, 0.61, 0.9}) {
    std::filesystem::remove_all(out);
    const auto size = static_cast<double>(size_of(whole / "scene.mlo"));
    run_and_kill(scans, out, static_cast<std::uint64_t>(share * size));
    expect_whole(out);
    std::vector<std::string> words = run_words(scans, out);
    words.emplace_back("--resume");
    ASSERT_EQ(run_program(words).exit_code, 0) << share;
    EXPECT_THAT(test::different_results(whole, out), testing::IsEmpty()) << share;
  }
}

TEST(KillSafety, AFullDiskIsAnErrorAndKeepsWhatIsFinished) {
  const std::filesystem::path scans = street_scans();
  const std::filesystem::path out = scans.parent_path() / "out";
  const std::filesystem::path err = scans.parent_path() / "err.txt";
  // No file may grow beyond 64 KiB: the system refuses to write more, as on a full disk.
  const std::string command =
      fmt::format("bash -c \"ulimit -f 64; exec '{}' -q run '{}' --out '{}' 2> '{}'\"", MLO_PROGRAM,
                  scans.string(), out.string(), err.string());
  const int status = std::system(command.c_str());
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_THAT(read_text(err), AllOf(HasSubstr("scene.mlo"), HasSubstr("free some space")));
  EXPECT_GT(SceneFile(out / "scene.mlo").num_scans(), 0U);
  expect_whole(out);
}

}  // namespace
}  // namespace mlo
