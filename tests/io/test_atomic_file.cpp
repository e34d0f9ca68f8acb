#include <csignal>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "io/file_bytes.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using test::count_files;
using test::read_bytes;
using test::TempFolder;
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
  const TempFolder folder;
  std::string content;
  for (int i = 0; i < 3'000'000; ++i) content += static_cast<char>(i * 7);
  write_file_atomically(folder.path() / "a.bin", content);
  EXPECT_EQ(read_bytes(folder.path() / "a.bin"), content);
  write_file_atomically(folder.path() / "a.bin", "");
  EXPECT_EQ(read_bytes(folder.path() / "a.bin"), "");
  EXPECT_EQ(count_files(folder.path()), 1U);
}

TEST(AtomicFile, KeepsTheOldFileUntilCommit) {
  const TempFolder folder;
  write_file_atomically(folder.path() / "a.txt", "old");
  {
    AtomicFile file(folder.path() / "a.txt");
    file.write("new");
    EXPECT_EQ(read_bytes(folder.path() / "a.txt"), "old");
  }
  EXPECT_EQ(read_bytes(folder.path() / "a.txt"), "old");
  EXPECT_EQ(count_files(folder.path()), 1U);
}

TEST(AtomicFile, IsNotDisturbedByWhatACrashLeftBehind) {
  const TempFolder folder;
  AtomicFile left_open(folder.path() / "a.txt");
  left_open.write("never committed");
  write_file_atomically(folder.path() / "a.txt", "new");
  EXPECT_EQ(read_bytes(folder.path() / "a.txt"), "new");
}

TEST(AtomicFile, SaysWhyItCannotBeWritten) {
  const TempFolder folder;
  EXPECT_THAT([&] { write_file_atomically(folder.path() / "missing" / "a.txt", "x"); },
              ThrowsMessage<InputError>(HasSubstr("create the folder")));
  write_file_atomically(folder.path() / "file", "x");
  EXPECT_THAT([&] { write_file_atomically(folder.path() / "file" / "a.txt", "x"); },
              ThrowsMessage<InputError>(HasSubstr("create the folder")));
  std::filesystem::create_directory(folder.path() / "sub");
  EXPECT_THAT([&] { write_file_atomically(folder.path() / "sub", "x"); },
              ThrowsMessage<InputError>(HasSubstr("a folder has this name")));
}

TEST(AtomicFile, SurvivesAFullDisk) {
  const TempFolder folder;
  write_file_atomically(folder.path() / "a.txt", "old");
  {
    const FileSizeLimit limit(10'000);
    EXPECT_THAT([&] { write_file_atomically(folder.path() / "a.txt", std::string(20'000, 'x')); },
                ThrowsMessage<InputError>(HasSubstr("free some space")));
  }
  EXPECT_EQ(read_bytes(folder.path() / "a.txt"), "old");
  EXPECT_EQ(count_files(folder.path()), 1U);
}

}  // namespace
}  // namespace mlo
