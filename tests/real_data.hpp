#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace mlo::test {

/// Use: `const auto data = real_data(); if (!data) GTEST_SKIP() << kNoRealData;`
inline constexpr const char* kNoRealData =
    "the real scans are absent: set MLO_TEST_DATA to the folder of kitti_odometry and kitti_raw, or put the "
    "packed "
    "data at ../shared/data beside the repository";

/// Unpacks by the data's own script, once: concurrent test programs wait for each other at a lock file.
inline bool unpack_once(const std::filesystem::path& script, const std::filesystem::path& destination) {
  std::filesystem::create_directories(destination);
  const int lock = open((destination / ".lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (lock < 0) return false;
  flock(lock, LOCK_EX);
  const std::filesystem::path done = destination / ".unpacked";
  if (!std::filesystem::exists(done)) {
    const std::string command = "'" + script.string() + "' '" + destination.string() + "' > /dev/null";
    if (std::system(command.c_str()) == 0) std::filesystem::create_directory(done);
  }
  close(lock);  // also unlocks
  return std::filesystem::exists(done);
}

/// The folder that holds kitti_odometry, kitti_raw, kitti_tracking and truth_lidar: MLO_TEST_DATA, or what is
/// packed in
/// ../shared/data beside the repository, unpacked into MLO_TEST_CACHE (default: the system's folder for
/// temporary files). Nothing if there is neither.
inline std::optional<std::filesystem::path> real_data() {
  namespace fs = std::filesystem;
  if (const char* given = std::getenv("MLO_TEST_DATA"); given != nullptr && *given != '\0') {
    if (fs::is_directory(given)) return fs::path(given);
    return std::nullopt;
  }
  const char* source = std::getenv("MLO_SOURCE_DIR");
  if (source == nullptr) return std::nullopt;
  const fs::path script = fs::path(source).parent_path() / "shared" / "data" / "unpack.sh";
  if (!fs::exists(script)) return std::nullopt;
  const char* cache = std::getenv("MLO_TEST_CACHE");
  const fs::path destination =
      cache != nullptr ? fs::path(cache) : fs::temp_directory_path() / "mlo-test-data";
  if (!unpack_once(script, destination)) return std::nullopt;
  return destination;
}

}  // namespace mlo::test
