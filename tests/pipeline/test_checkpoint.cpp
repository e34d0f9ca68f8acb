#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file_bytes.hpp"
#include "mlo/core/error.hpp"
#include "mlo/pipeline/checkpoint.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::HasSubstr;

class Checkpoint : public testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path() / "state.bin"; }

  test::TempFolder folder_;
};

TEST_F(Checkpoint, GivesTheStateBack) {
  const std::string state("some\0state", 10);
  write_checkpoint(file(), "owner", state);
  EXPECT_EQ(read_checkpoint(file(), "owner"), state);
}

TEST_F(Checkpoint, WithoutAFileThereIsNone) {
  EXPECT_EQ(read_checkpoint(file(), "owner"), std::nullopt);
}

TEST_F(Checkpoint, OfAnotherOwnerNamesTheFirstLineThatDiffers) {
  write_checkpoint(file(), "a: 1\nb: 2\n", "state");
  try {
    read_checkpoint(file(), "a: 1\nb: 3\n");
    FAIL() << "it was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("'b: 2'"), HasSubstr("'b: 3'")));
  }
}

// Some bits of compressed data mean nothing: damage there leaves the state as it was, and is found all the
// same.
TEST_F(Checkpoint, AnyFlippedBitAndAnyMissingByteIsDamage) {
  std::string state;
  for (int i = 0; i < 100; ++i) state += fmt::format("{} and {};", i, i * i % 37);
  write_checkpoint(file(), "owner", state);
  const std::string bytes = test::read_bytes(file());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    EXPECT_THROW(
        {
          folder_.write("state.bin", bytes.substr(0, i));
          read_checkpoint(file(), "owner");
        },
        InputError)
        << i << " bytes";
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      folder_.write("state.bin", damaged);
      EXPECT_THROW(read_checkpoint(file(), "owner"), InputError) << "bit " << bit << " of byte " << i;
    }
  }
}

}  // namespace
}  // namespace mlo
