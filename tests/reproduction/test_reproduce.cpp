#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/reproduction/reproduce.hpp"
#include "real_data.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::HasSubstr;

const PaperTable& reproduced_table(const PaperTables& tables, const std::string& name) {
  for (const PaperTable& table : tables.tables) {
    if (table.name == name) return table;
  }
  throw std::runtime_error("no table " + name);
}

ReproduceProgress silent() {
  return {.on_run = [](const std::string&) {},
          .on_scan = [](std::size_t, std::size_t) {},
          .should_stop = [] { return false; }};
}

TEST(Reproduce, WithoutDataEveryRowIsNamedAsMissing) {
  const PaperTables paper = paper_tables();
  for (const PaperTable& table : paper.tables) {
    const ReproducedTable result = reproduce_table(table, {}, {}, silent());
    EXPECT_EQ(result.rows.size(), table.rows.size()) << table.name;
    EXPECT_EQ(result.missing.size(), table.rows.size()) << table.name;
    const std::string text = to_text(result);
    EXPECT_THAT(text, testing::AllOf(HasSubstr(table.name), HasSubstr("missing:"), HasSubstr("paper: ")));
  }
}

TEST(Reproduce, TextHoldsThePapersValuesBesideOurs) {
  const PaperTables paper = paper_tables();
  ReproducedTable table{
      .paper = reproduced_table(paper, "Table II"), .titles = {"here"}, .rows = {}, .missing = {}};
  table.rows.push_back(
      {.paper = table.paper.rows[2], .has_data = true, .here = {{0.5, std::nullopt, 0.25}}, .note = {}});
  const std::string text = to_text(table);
  EXPECT_THAT(text, HasSubstr("ATE [m] / RTE [m/f] / RRE [deg/f]"));
  EXPECT_THAT(text, HasSubstr("fail / 0.51 / 0.15"));
  EXPECT_THAT(text, HasSubstr("0.50 / - / 0.25"));
}

TEST(Reproduce, RunsARealSequenceOnceAndTakesItFromDiskAfterwards) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const test::TempFolder folder;
  const PaperTables paper = paper_tables();
  PaperTable table = reproduced_table(paper, "Table I");
  std::erase_if(table.rows, [](const PaperRow& row) { return row.name != "04" && row.name != "00"; });
  const ReproduceOptions options{.out = folder.path(), .last_frame = 5};
  std::size_t scans = 0;
  ReproduceProgress progress = silent();
  progress.on_scan = [&](std::size_t, std::size_t) { ++scans; };
  const KittiData found = find_kitti(*data);
  const ReproducedTable first = reproduce_table(table, found, options, progress);
  EXPECT_EQ(scans, 2U * 6U);  // two variants
  EXPECT_THAT(first.missing, testing::ElementsAre("00"));
  ASSERT_EQ(first.rows.size(), 2U);
  ASSERT_EQ(first.rows[1].here.size(), 2U);
  EXPECT_LT(first.rows[1].here[1][0].value(), 0.1);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "kitti_odometry_04/default/run.json"));
  const ReproducedTable second = reproduce_table(table, found, options, progress);
  EXPECT_EQ(scans, 2U * 6U);  // nothing was run again
  EXPECT_EQ(to_text(first), to_text(second));
}

TEST(Reproduce, StoppedRunsAreDoneAgain) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const test::TempFolder folder;
  const PaperTables paper = paper_tables();
  PaperTable table = reproduced_table(paper, "Table I");
  std::erase_if(table.rows, [](const PaperRow& row) { return row.name != "04"; });
  const ReproduceOptions options{.out = folder.path(), .last_frame = 5};
  std::size_t scans = 0;
  ReproduceProgress progress = silent();
  progress.on_scan = [&](std::size_t, std::size_t) { ++scans; };
  progress.should_stop = [&] { return scans >= 2; };
  const ReproducedTable stopped = reproduce_table(table, find_kitti(*data), options, progress);
  EXPECT_FALSE(stopped.rows[0].here[0][0]);
  scans = 0;
  progress.should_stop = [] { return false; };
  EXPECT_TRUE(reproduce_table(table, find_kitti(*data), options, progress).rows[0].here[0][0]);
  EXPECT_EQ(scans, 2U * 6U);
}

PaperTable object_table(const std::vector<std::string>& rows) {
  PaperTable table = reproduced_table(paper_tables(), "Table IV");
  const PaperRow shape = table.rows.front();
  table.rows.clear();
  for (const std::string& name : rows) table.rows.push_back({.name = name, .values = shape.values});
  return table;
}

TEST(Reproduce, MeasuresObjectsInThreeModes) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const test::TempFolder folder;
  const ReproduceOptions options{.out = folder.path(), .last_frame = 20};
  std::size_t scans = 0;
  ReproduceProgress progress = silent();
  progress.on_scan = [&](std::size_t, std::size_t) { ++scans; };
  // The cyclist and the van that ride ahead of the lidar, and an object that comes later.
  const ReproducedTable result = reproduce_table(object_table({"0926-0005 1", "0926-0005 0", "0926-0005 14"}),
                                                 find_kitti(*data), options, progress);
  EXPECT_EQ(scans, 3U * 21U);  // three modes, once for all objects of the drive
  EXPECT_THAT(result.missing, testing::ElementsAre("0926-0005 14"));
  ASSERT_EQ(result.titles.size(), 3U);
  for (const double ate_m : {result.rows[1].here[0][0].value(), result.rows[1].here[1][0].value(),
                             result.rows[1].here[2][0].value()}) {
    EXPECT_GT(ate_m, 0.0);
    EXPECT_LT(ate_m, 0.5);
  }
  EXPECT_NE(result.rows[1].here[0], result.rows[1].here[1]);  // geometry is not semantic
  EXPECT_NE(result.rows[1].here[1], result.rows[1].here[2]);
  EXPECT_FALSE(result.rows[0].here[0][0]);  // no cyclists among the boxes: lost
  EXPECT_THAT(result.rows[0].note, HasSubstr("labelled in 21 scans"));
}

TEST(Reproduce, SaysWhatAnObjectLacks) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const test::TempFolder folder;
  KittiData found = find_kitti(*data);
  found.car_detections.reset();
  const ReproduceOptions options{.out = folder.path()};
  const ReproducedTable result =
      reproduce_table(object_table({"0926-0005 0", "0926-0084 14"}), found, options, silent());
  EXPECT_EQ(result.missing.size(), 2U);
  EXPECT_THAT(result.rows[0].note, HasSubstr("no detections"));
  EXPECT_THAT(result.rows[1].note, HasSubstr("data missing"));
}

TEST(Reproduce, ScoresTheTenSequences) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const PaperTables paper = paper_tables();
  const ReproducedTable result =
      reproduce_table(reproduced_table(paper, "Table III"), find_kitti(*data), {}, silent());
  EXPECT_TRUE(result.missing.empty());
  ASSERT_EQ(result.rows.size(), 1U);
  EXPECT_GT(result.rows[0].here[0][0].value(), 77.55);  // the paper's MOTA
  EXPECT_GT(result.rows[0].here[0][2].value(), 0.0);
}

}  // namespace
}  // namespace mlo
