#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/program.hpp"
#include "apps/room.hpp"

namespace mlo {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Detect, WritesBoxesAndCandidates) {
  const std::filesystem::path sequence = room_sequence();
  const std::filesystem::path boxes = sequence.parent_path() / "boxes.csv";
  const std::filesystem::path candidates = sequence.parent_path() / "candidates.csv";
  const ProgramRun run = run_program(
      {"-q", "detect", sequence.string(), "--out", boxes.string(), "--candidates", candidates.string()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("4 of 4 scans"), HasSubstr(boxes.string())));
  EXPECT_THAT(read_text(boxes), StartsWith("frame,class,x_m,"));
  EXPECT_THAT(read_text(candidates), AllOf(StartsWith("frame,class,x_m,"), HasSubstr("ground_inside")));
}

TEST(Detect, NeedsSomethingToWrite) {
  const ProgramRun run = run_program({"detect", "somewhere"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--out"));
}

}  // namespace
}  // namespace mlo
