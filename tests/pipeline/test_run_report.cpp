#include <numeric>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "mlo/pipeline/run_report.hpp"

namespace mlo {
namespace {

TEST(RunReport, StatisticsOfNothingAreZero) {
  const TimeStatistics none = statistics({});
  EXPECT_EQ(none.mean_ms, 0.0);
  EXPECT_EQ(none.p50_ms, 0.0);
  EXPECT_EQ(none.p99_ms, 0.0);
  EXPECT_EQ(none.max_ms, 0.0);
}

TEST(RunReport, PercentilesAreNearestRanks) {
  const TimeStatistics one = statistics({7.0});
  EXPECT_EQ(one.mean_ms, 7.0);
  EXPECT_EQ(one.p50_ms, 7.0);
  EXPECT_EQ(one.p99_ms, 7.0);

  const TimeStatistics four = statistics({40.0, 10.0, 30.0, 20.0});
  EXPECT_EQ(four.mean_ms, 25.0);
  EXPECT_EQ(four.p50_ms, 20.0);
  EXPECT_EQ(four.p99_ms, 40.0);
  EXPECT_EQ(four.max_ms, 40.0);

  std::vector<double> hundred(100);
  std::iota(hundred.rbegin(), hundred.rend(), 1.0);
  EXPECT_EQ(statistics(hundred).p50_ms, 50.0);
  EXPECT_EQ(statistics(hundred).p99_ms, 99.0);
  EXPECT_EQ(statistics(hundred).max_ms, 100.0);
}

TEST(RunReport, StagesAndScansAreCountedApart) {
  RunSummary summary;
  for (const double ms : {1.0, 3.0}) {
    StageTimes times;
    times[Stage::odometry] = ms;
    times[Stage::refinement] = 10.0 * ms;
    summary.times.push_back(times);
  }
  EXPECT_EQ(stage_statistics(summary, Stage::odometry).mean_ms, 2.0);
  EXPECT_EQ(stage_statistics(summary, Stage::prepare).mean_ms, 0.0);
  EXPECT_EQ(scan_statistics(summary).max_ms, 33.0);
}

TEST(RunReport, NamesThatAreNotUtf8GiveValidJson) {
  Dataset dataset;
  dataset.root =
      "/data/stra\xDF"
      "e";
  const nlohmann::json report = nlohmann::json::parse(to_json(dataset, {}, {}));
  EXPECT_EQ(report.at("scans"), 0);
  EXPECT_EQ(report.at("input").at("folder"),
            "/data/stra\xEF\xBF\xBD"
            "e");
}

TEST(RunReport, PeakMemoryIsThatOfAProcess) {
  EXPECT_GT(peak_memory_mib(), 1.0);
  EXPECT_LT(peak_memory_mib(), 1e6);
}

}  // namespace
}  // namespace mlo
