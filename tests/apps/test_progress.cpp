#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/mlo/progress.hpp"

namespace mlo::apps {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Output of a job of `total` scans that take `scan_s` each.
std::string output_of(Progress::Style style, std::size_t total, double scan_s) {
  std::ostringstream out;
  double now_s = 1000.0;
  Progress progress("scans", total, style, out, [&] { return now_s; });
  for (std::size_t done = 0; done <= total; ++done) {
    progress.update(done);
    now_s += scan_s;
  }
  progress.finish();
  return out.str();
}

TEST(ProgressText, HasCountRateAndTimeLeft) {
  EXPECT_EQ(progress_text("scans", 50, 200, 5.0), "50/200 scans (25%), 10.0 scans/s, 0:15 left");
  EXPECT_EQ(progress_text("scans", 1, 7201, 1.0), "1/7201 scans (0%), 1.0 scans/s, 2:00:00 left");
  EXPECT_EQ(progress_text("scans", 200, 200, 5.0), "200/200 scans (100%), 40.0 scans/s");
}

TEST(ProgressText, KnowsNoRateAtTheStart) {
  EXPECT_EQ(progress_text("scans", 0, 200, 3.0), "0/200 scans (0%)");
  EXPECT_EQ(progress_text("scans", 1, 200, 0.0), "1/200 scans (0%)");
  EXPECT_EQ(progress_text("scans", 0, 0, 0.0), "0/0 scans (100%)");
}

TEST(Progress, WritesAFewPlainLinesIntoAFile) {
  const std::string slow = output_of(Progress::Style::lines, 100, 1.0);
  EXPECT_EQ(std::count(slow.begin(), slow.end(), '\n'), 10);
  const std::string fast = output_of(Progress::Style::lines, 1000, 0.01);
  EXPECT_EQ(std::count(fast.begin(), fast.end(), '\n'), 2);  // after 5 s, and at the end
  EXPECT_THAT(slow, AllOf(HasSubstr("100/100 scans (100%), 1.0 scans/s\n"), Not(HasSubstr("\r"))));
}

TEST(Progress, RedrawsABarOnATerminal) {
  const std::string bar = output_of(Progress::Style::bar, 10, 1.0);
  EXPECT_EQ(std::count(bar.begin(), bar.end(), '\r'), 10);
  EXPECT_EQ(std::count(bar.begin(), bar.end(), '\n'), 1);
  EXPECT_THAT(bar, HasSubstr("[###############...............] 5/10 scans (50%), 1.0 scans/s, 0:05 left"));
  EXPECT_EQ(std::count(bar.begin(), bar.end(), '#'), 3 * (1 + 2 + 3 + 4 + 5 + 6 + 7 + 8 + 9 + 10));
}

TEST(Progress, IsSilentWhenAskedTo) {
  EXPECT_EQ(output_of(Progress::Style::none, 10, 1.0), "");
}

TEST(Progress, EndsTheLineOfAJobThatStopsEarly) {
  std::ostringstream out;
  double now_s = 0.0;
  {
    Progress progress("scans", 10, Progress::Style::bar, out, [&] { return now_s; });
    now_s = 1.0;
    progress.update(3);
  }
  EXPECT_EQ(out.str().back(), '\n');
}

}  // namespace
}  // namespace mlo::apps
