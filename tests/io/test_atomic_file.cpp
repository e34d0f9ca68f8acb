#include <csignal>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "io/scratch_folder.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"

namespace mlo {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// While it lives, files can not grow beyond a size: what a full disk looks like to a program.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST(AtomicFile, WritesAllBytesAndLeavesNothingBeside) {
  const ScratchFolder folder;
  std::string content;
  for (int i = 0; i < 3'000'000; ++i) content += static_cast<char>(i * 7);
  write_file_atomically(folder / "a.bin", content);
  EXPECT_EQ(read_bytes(folder / "a.bin"), content);
  write_file_atomically(folder / "a.bin", "");
  EXPECT_EQ(read_bytes(folder / "a.bin"), "");
  EXPECT_EQ(folder.count_files(), 1U);
}

TEST(AtomicFile, KeepsTheOldFileUntilCommit) {
  const ScratchFolder folder;
  write_file_atomically(folder / "a.txt", "old");
  {
    AtomicFile file(folder / "a.txt");
    file.write("new");
    EXPECT_EQ(read_bytes(folder / "a.txt"), "old");
  }
  EXPECT_EQ(read_bytes(folder / "a.txt"), "old");
  EXPECT_EQ(folder.count_files(), 1U);
}

TEST(AtomicFile, IsNotDisturbedByWhatACrashLeftBehind) {
  const ScratchFolder folder;
  AtomicFile left_open(folder / "a.txt");
  left_open.write("never committed");
  write_file_atomically(folder / "a.txt", "new");
  EXPECT_EQ(read_bytes(folder / "a.txt"), "new");
}

TEST(AtomicFile, SaysWhyItCannotBeWritten) {
  const ScratchFolder folder;
  EXPECT_THAT([&] { write_file_atomically(folder / "missing" / "a.txt", "x"); },
              ThrowsMessage<InputError>(HasSubstr("create the folder")));
  write_file_atomically(folder / "file", "x");
  EXPECT_THAT([&] { write_file_atomically(folder / "file" / "a.txt", "x"); },
              ThrowsMessage<InputError>(HasSubstr("create the folder")));
  std::filesystem::create_directory(folder / "sub");
  EXPECT_THAT([&] { write_file_atomically(folder / "sub", "x"); },
              ThrowsMessage<InputError>(HasSubstr("a folder has this name")));
}

TEST(AtomicFile, SurvivesAFullDisk) {
  const ScratchFolder folder;
  write_file_atomically(folder / "a.txt", "old");
  {
    const FileSizeLimit limit(10'000);
    EXPECT_THAT([&] { write_file_atomically(folder / "a.txt", std::string(20'000, 'x')); },
                ThrowsMessage<InputError>(HasSubstr("free some space")));
  }
  EXPECT_EQ(read_bytes(folder / "a.txt"), "old");
  EXPECT_EQ(folder.count_files(), 1U);
}

}  // namespace
}  // namespace mlo
