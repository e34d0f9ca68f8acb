#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file_bytes.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/append_file.hpp"
#include "mlo/io/random_access_file.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::HasSubstr;

template <class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "it went through";
  return {};
}

TEST(AppendFile, WhatWasAppendedIsThereAtOnce) {
  const test::TempFolder folder;
  const std::filesystem::path path = folder.write("file", "old and longer");
  AppendFile file(path);
  file.append("one");
  EXPECT_EQ(test::read_bytes(path), "one");
  file.append(" two");
  EXPECT_EQ(test::read_bytes(path), "one two");
  EXPECT_EQ(file.size(), 7U);
}

TEST(AppendFile, GoesOnAfterTheBytesThatAreKept) {
  const test::TempFolder folder;
  const std::filesystem::path path = folder.write("file", "keep drop");
  AppendFile file(path, 5);
  file.append("new");
  EXPECT_EQ(test::read_bytes(path), "keep new");
  EXPECT_EQ(file.size(), 8U);
}

TEST(AppendFile, AShorterOrMissingFileIsAnInputError) {
  const test::TempFolder folder;
  const std::filesystem::path path = folder.write("file", "abc");
  EXPECT_THAT(message_of([&] { AppendFile(path, 4); }), HasSubstr(path.string()));
  EXPECT_EQ(test::read_bytes(path), "abc");
  message_of([&] { AppendFile(folder.path() / "absent", 0); });
}

TEST(AppendFile, AFullDiskAndAMissingFolderAreInputErrorsWithARemedy) {
  EXPECT_THAT(message_of([] { AppendFile("/dev/full").append("x"); }), HasSubstr("free some space"));
  EXPECT_THAT(message_of([] { AppendFile("/absent/file"); }), HasSubstr("create the folder first"));
}

TEST(RandomAccessFile, ReadsPieces) {
  const test::TempFolder folder;
  const RandomAccessFile file(folder.write("file", "0123456789"));
  EXPECT_EQ(file.size(), 10U);
  EXPECT_EQ(file.read(3, 4), "3456");
  EXPECT_EQ(file.read(8, 4), "89");
  EXPECT_EQ(file.read(10, 4), "");
  EXPECT_EQ(file.read(99, 4), "");
}

TEST(RandomAccessFile, WhatIsNoFileIsAnInputError) {
  const test::TempFolder folder;
  message_of([&] { RandomAccessFile(folder.path() / "absent"); });
  message_of([&] { RandomAccessFile(folder.path()); });
}

}  // namespace
}  // namespace mlo
