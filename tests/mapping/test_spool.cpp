#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/mapping/spool.hpp"

namespace mlo {
namespace {

TEST(Spool, GivesBackWhatWasWritten) {
  Spool spool;
  const std::vector<int> first{1, 2, 3};
  const std::vector<int> second{4, 5};
  const std::uint64_t first_place = spool.write(std::as_bytes(std::span(first)));
  const std::uint64_t second_place = spool.write(std::as_bytes(std::span(second)));
  std::vector<int> back(2);
  spool.read(second_place, std::as_writable_bytes(std::span(back)));
  EXPECT_EQ(back, second);
  back.resize(3);
  spool.read(first_place, std::as_writable_bytes(std::span(back)));
  EXPECT_EQ(back, first);
}

TEST(Spool, ReadingNothingNeedsNoFileAndReadingTooMuchIsAnError) {
  Spool spool;
  spool.read(0, {});
  std::vector<std::byte> bytes(1);
  EXPECT_THROW(spool.read(0, bytes), InputError);
}

TEST(Spool, NamesTheFolderThatCannotBeWritten) {
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  setenv("TMPDIR", "/proc", 1);
  Spool spool;
  const std::vector<std::byte> bytes(10);
  try {
    spool.write(bytes);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/proc"), std::string::npos) << error.what();
  }
  if (before == nullptr) {
    unsetenv("TMPDIR");
  } else {
    setenv("TMPDIR", kept.c_str(), 1);
  }
}

}  // namespace
}  // namespace mlo
