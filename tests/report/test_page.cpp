#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/report/page.hpp"
#include "report/run_files.hpp"

namespace mlo {
namespace {

using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

ReportedRun reported(const TempFolder& folder, const std::string& name) {
  return {.run = read_run_folder(test::write_run(folder, name)), .errors = {}, .truth_name = {}};
}

TEST(ReportPage, HoldsTheRunsSideBySide) {
  const TempFolder folder;
  const std::vector<ReportedRun> runs{reported(folder, "first"), reported(folder, "second")};
  const std::string page = report_page(runs);
  EXPECT_THAT(
      page,
      AllOf(HasSubstr("<th>first</th><th>second</th>"), HasSubstr("<td>skipped</td><td>1</td><td>1</td>"),
            HasSubstr("<td>path [m]</td><td>2.5</td><td>2.5</td>"), HasSubstr("perception"),
            HasSubstr("<td>boxes from</td><td>cluster</td><td>cluster</td>"),
            HasSubstr("Path seen from above"), HasSubstr("data:image/png"), HasSubstr("@media print")));
  EXPECT_THAT(page, Not(HasSubstr("ATE")));  // there is no truth
  EXPECT_EQ(page, report_page(runs));
}

TEST(ReportPage, LoadsNothingFromElsewhere) {
  const TempFolder folder;
  const std::string page = report_page(std::vector<ReportedRun>{reported(folder, "a")});
  for (const char* reference : {"src=", "url(", "@import", "<link", "<script", "href=\"http", "href=\"/"}) {
    EXPECT_THAT(page, Not(HasSubstr(reference)));
  }
}

TEST(ReportPage, TextIsEscaped) {
  const TempFolder folder;
  const std::string page = report_page(std::vector<ReportedRun>{reported(folder, "a")});
  EXPECT_THAT(page, AllOf(HasSubstr("something &lt;odd&gt; &amp; strange"), Not(HasSubstr("<odd>"))));
  EXPECT_EQ(html_escaped("\"a\" < b"), "&quot;a&quot; &lt; b");
}

TEST(ReportPage, ErrorsWhereThereIsTruth) {
  const TempFolder folder;
  ReportedRun run = reported(folder, "a");
  std::vector<SE3> truth = run.run.trajectory.T_world_body;
  truth[2] = SE3(Eigen::Quaterniond::Identity(), {21.0, 0.0, 0.0});
  PoseMatching matching =
      match_poses({run.run.trajectory.frames, {}, truth},
                  {run.run.trajectory.frames, {}, run.run.trajectory.T_world_body}, MatchBy::frame);
  const TrajectoryErrors errors = trajectory_errors(matching);
  run.errors = TrajectoryEvaluation{"a", matching, errors};
  run.truth_name = "poses.txt";
  const std::string page = report_page(std::vector<ReportedRun>{run});
  EXPECT_THAT(page, AllOf(HasSubstr("<td>RTE [m/frame]</td><td>0.5000</td>"), HasSubstr("poses.txt"),
                          HasSubstr("Position error after alignment")));
}

TEST(ReportPage, NoRunsIsAnEmptyPage) {
  EXPECT_THAT(report_page({}), AllOf(HasSubstr("<!DOCTYPE html>"), HasSubstr("</html>")));
}

}  // namespace
}  // namespace mlo
