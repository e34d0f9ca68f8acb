#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file_bytes.hpp"
#include "mlo/core/error.hpp"
#include "mlo/scene/chunk_file.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::HasSubstr;

std::string payload_of(std::uint64_t number) {
  return "payload " + std::string(100 * number, 'x') + std::to_string(number);
}

void append(ChunkFileWriter& writer, std::uint64_t number) {
  writer.append({.type = ChunkType::scan, .number = number, .first_stamp_s = 0.5}, payload_of(number));
}

std::filesystem::path write_chunks(const test::TempFolder& folder, std::uint64_t count, bool finished) {
  const std::filesystem::path path = folder.path() / "file.mlo";
  ChunkFileWriter writer(path, 1);
  for (std::uint64_t i = 0; i < count; ++i) append(writer, i);
  if (finished) writer.finish();
  return path;
}

void expect_chunks(const ChunkFile& file, std::size_t count) {
  ASSERT_EQ(file.chunks().size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(file.chunks()[i].info.number, i);
    EXPECT_EQ(file.chunks()[i].info.first_stamp_s, 0.5);
    EXPECT_EQ(file.payload(file.chunks()[i]), payload_of(i));
  }
}

std::string message_of(const std::filesystem::path& path) {
  try {
    const ChunkFile file(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(ChunkFile, ComesBackByItsIndex) {
  const test::TempFolder folder;
  for (const std::uint64_t count : {0U, 1U, 5U}) {
    const ChunkFile file(write_chunks(folder, count, true));
    EXPECT_TRUE(file.complete());
    expect_chunks(file, count);
  }
}

// Whatever a killed program leaves is a file that was cut off somewhere.
TEST(ChunkFile, CutOffAnywhereItHasTheChunksBefore) {
  const test::TempFolder folder;
  const std::string bytes = test::read_bytes(write_chunks(folder, 4, true));
  const std::vector<IndexedChunk> chunks = ChunkFile(folder.path() / "file.mlo").chunks();
  for (std::size_t size = 12; size < bytes.size(); ++size) {
    const ChunkFile file(folder.write("cut.mlo", bytes.substr(0, size)));
    std::size_t whole = 0;
    while (whole < 4 && size >= (whole < 3 ? chunks[whole + 1].offset
                                           : chunks[3].offset + 56 + chunks[3].info.stored_bytes)) {
      ++whole;
    }
    EXPECT_FALSE(file.complete());
    expect_chunks(file, whole);
  }
}

TEST(ChunkFile, ADamagedChunkIsTold) {
  const test::TempFolder folder;
  const std::filesystem::path path = write_chunks(folder, 3, true);
  std::string bytes = test::read_bytes(path);
  const IndexedChunk second = ChunkFile(path).chunks()[1];
  bytes[second.offset + 56 + 3] ^= 1;
  const ChunkFile file(folder.write("damaged.mlo", bytes));
  EXPECT_EQ(file.payload(file.chunks()[0]), payload_of(0));
  EXPECT_THROW(file.payload(file.chunks()[1]), InputError);
  EXPECT_EQ(file.payload(file.chunks()[2]), payload_of(2));
}

TEST(ChunkFile, ADamagedIndexIsMadeAnew) {
  const test::TempFolder folder;
  std::string bytes = test::read_bytes(write_chunks(folder, 3, true));
  bytes[bytes.size() - 20] ^= 1;
  const ChunkFile file(folder.write("damaged.mlo", bytes));
  EXPECT_FALSE(file.complete());
  expect_chunks(file, 3);
}

TEST(ChunkFile, GoesOnAfterTheChunksThatAreKept) {
  const test::TempFolder folder;
  const std::filesystem::path path = write_chunks(folder, 5, true);
  std::vector<IndexedChunk> kept = ChunkFile(path).chunks();
  kept.resize(2);
  {
    ChunkFileWriter writer(path, 1, kept);
    for (std::uint64_t i = 2; i < 4; ++i) append(writer, i);
    writer.finish();
  }
  const ChunkFile file(path);
  EXPECT_TRUE(file.complete());
  expect_chunks(file, 4);
}

TEST(ChunkFile, OtherFilesAreInputErrors) {
  const test::TempFolder folder;
  EXPECT_THAT(message_of(folder.path() / "absent"), HasSubstr("cannot be read"));
  EXPECT_THAT(message_of(folder.path()), HasSubstr("cannot be read"));
  EXPECT_THAT(message_of(folder.write("empty", "")), HasSubstr("no scene file"));
  EXPECT_THAT(message_of(folder.write("text", "something else altogether")), HasSubstr("no scene file"));
  EXPECT_THAT(message_of(folder.write("new", std::string("MLOSCENE\x09\0\0\0", 12))),
              HasSubstr("another version"));
}

TEST(ChunkFile, AFullDiskIsAnInputErrorWithARemedy) {
  try {
    ChunkFileWriter writer("/dev/full", 1);
    FAIL() << "it was written";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("free some space"));
  }
}

TEST(ChunkFile, AMissingFolderIsAnInputErrorWithARemedy) {
  const test::TempFolder folder;
  try {
    ChunkFileWriter writer(folder.path() / "absent" / "file.mlo", 1);
    FAIL() << "it was written";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("create the folder first"));
  }
}

}  // namespace
}  // namespace mlo
