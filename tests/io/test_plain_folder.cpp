#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/synthetic_sweep.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/dataset.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string small_bin() {
  return test::to_bin(test::make_sweep({.sensor = hdl64e(), .columns = 60}));
}

// Three points with times [s] and rings counted from the lowest.
std::string timed_pcd(double t0, double t1, double t2) {
  return fmt::format(
      "VERSION 0.7\nFIELDS x y z intensity time ring\nSIZE 4 4 4 4 8 2\nTYPE F F F F F U\nCOUNT 1 1 1 1 1 "
      "1\nWIDTH "
      "3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n10 0 1 0.5 {} 2\n10 1 0 0.5 {} 1\n10 2 -1 "
      "0.5 {} 0\n",
      t0, t1, t2);
}

std::vector<double> fractions(const Scan& scan) {
  std::vector<double> result;
  for (const Point& point : scan.points) result.push_back(point.sweep_fraction);
  return result;
}

TEST(PlainFolder, NaturalOrderAndStampsLineByLine) {
  const test::TempFolder folder;
  for (const char* name : {"scan10.bin", "scan9.bin", "scan1.bin", "notes.md"})
    folder.write(name, small_bin());
  folder.write("timestamps.txt", "1.0\n1.25\n1.5\n");
  const Dataset dataset = open_dataset(folder.path(), {});
  EXPECT_EQ(dataset.format, "folder");
  EXPECT_EQ(dataset.sequence, "");
  EXPECT_THAT(dataset.warnings, IsEmpty());
  ASSERT_EQ(dataset.scans->size(), 3U);
  const ScanReading last = dataset.scans->read(2);
  ASSERT_TRUE(last.scan.has_value()) << last.problem;
  EXPECT_EQ(last.scan->frame, 2U);
  EXPECT_EQ(last.scan->stamp_s, 1.5);
  EXPECT_EQ(last.scan->duration_s, 0.25);
  folder.write("scan10.bin", "123");
  EXPECT_THAT(dataset.scans->read(2).problem, HasSubstr("scan10.bin"));
}

TEST(PlainFolder, NumberedFilesHaveGaps) {
  const test::TempFolder folder;
  for (const char* name : {"0007.bin", "0008.bin", "0010.bin"}) folder.write(name, small_bin());
  folder.write("times.txt", "2011-09-26 13:04:32.0\n2011-09-26 13:04:32.1\n2011-09-26 13:04:32.3\n");
  const Dataset dataset = open_dataset(folder.path(), {});
  ASSERT_EQ(dataset.scans->size(), 4U);
  EXPECT_EQ(dataset.scans->frame(0), 7U);
  EXPECT_THAT(dataset.scans->read(2).problem, HasSubstr("0009.bin: the scan is missing"));
  EXPECT_NEAR(dataset.scans->read(3).scan->stamp_s - dataset.scans->read(0).scan->stamp_s, 0.3, 1e-6);
}

TEST(PlainFolder, NamesThatAreTimesAreNoFrames) {
  const test::TempFolder folder;
  for (const char* name : {"1317042272335337762.bin", "1317042272438625628.bin"})
    folder.write(name, small_bin());
  const Dataset dataset = open_dataset(folder.path(), {});
  ASSERT_EQ(dataset.scans->size(), 2U);
  EXPECT_EQ(dataset.scans->frame(1), 1U);
  EXPECT_THAT(dataset.warnings, ElementsAre(HasSubstr("placed 0.1000 s apart")));
}

TEST(PlainFolder, RingsAreRecoveredOrLeftOut) {
  const test::TempFolder folder;
  std::vector<Point> sweep = test::make_sweep({.sensor = hdl64e(), .columns = 60});
  folder.write("0.bin", test::to_bin(sweep));
  std::shuffle(sweep.begin(), sweep.end(), std::mt19937(5));
  folder.write("1.bin", test::to_bin(sweep));
  const Dataset dataset = open_dataset(folder.path(), {});
  EXPECT_EQ(dataset.sensor.rings, 0);
  EXPECT_EQ(dataset.scans->read(0).scan->points.back().ring, 63);
  const ScanReading shuffled = dataset.scans->read(1);
  for (const Point& point : shuffled.scan->points) ASSERT_EQ(point.ring, Point::kNoRing);
}

TEST(PlainFolder, TheSensorGivenSaysHowASweepRuns) {
  const test::TempFolder folder;
  folder.write("0.bin", small_bin());
  SensorConfig sensor;
  const double before = open_dataset(folder.path(), {}).scans->read(0).scan->points.front().sweep_fraction;
  sensor.clockwise = false;
  const Dataset dataset = open_dataset(folder.path(), {.sensor = sensor});
  EXPECT_NEAR(dataset.scans->read(0).scan->points.front().sweep_fraction, 1.0 - before, 1e-5);
}

TEST(PlainFolder, TimesFromTheStamp) {
  const test::TempFolder folder;
  folder.write("0.pcd", timed_pcd(0.0, 0.025, 0.1));
  folder.write("1.pcd", timed_pcd(-0.1, -0.05, 0.0));
  folder.write("2.pcd", timed_pcd(0.02, 0.045, 0.12));
  folder.write("timestamps.txt", "5.0\n5.1\n5.2\n");
  const Dataset dataset = open_dataset(folder.path(), {});
  const ScanReading at_start = dataset.scans->read(0);
  ASSERT_TRUE(at_start.scan.has_value()) << at_start.problem;
  EXPECT_THAT(fractions(*at_start.scan), ElementsAre(0.0, 0.25, 1.0));
  EXPECT_EQ(at_start.scan->stamp_fraction, 0.0);
  EXPECT_EQ(at_start.scan->stamp_s, 5.0);
  EXPECT_NEAR(at_start.scan->duration_s, 0.1, 1e-12);
  EXPECT_EQ(at_start.scan->points[0].ring, 0);  // the file counts from the lowest
  EXPECT_EQ(at_start.scan->points[2].ring, 2);
  const ScanReading at_end = dataset.scans->read(1);
  EXPECT_THAT(fractions(*at_end.scan), ElementsAre(0.0, 0.5, 1.0));
  EXPECT_EQ(at_end.scan->stamp_fraction, 1.0);
  EXPECT_NEAR(at_end.scan->stamp_s, 5.1, 1e-12);
  const ScanReading before_start = dataset.scans->read(2);
  EXPECT_EQ(before_start.scan->stamp_fraction, 0.0);
  EXPECT_NEAR(before_start.scan->stamp_s, 5.22, 1e-12);
}

TEST(PlainFolder, TimesOnAClock) {
  const test::TempFolder folder;
  folder.write("0.pcd", timed_pcd(1000.0, 1000.025, 1000.1));
  folder.write("1.pcd", timed_pcd(1000.1, 1000.15, 1000.2));
  folder.write("timestamps.txt", "1000.075\n77\n");
  const Dataset dataset = open_dataset(folder.path(), {});
  const ScanReading same_clock = dataset.scans->read(0);
  ASSERT_TRUE(same_clock.scan.has_value()) << same_clock.problem;
  EXPECT_NEAR(same_clock.scan->stamp_fraction, 0.75, 1e-9);
  EXPECT_EQ(same_clock.scan->stamp_s, 1000.075);
  const ScanReading other_clock = dataset.scans->read(1);
  EXPECT_NEAR(other_clock.scan->stamp_fraction, 0.5, 1e-9);
  EXPECT_NEAR(other_clock.scan->stamp_s, 1000.15, 1e-9);
}

TEST(PlainFolder, EqualTimesAreNone) {
  const test::TempFolder folder;
  folder.write("0.pcd", timed_pcd(0.0, 0.0, 0.0));
  const ScanReading reading = open_dataset(folder.path(), {}).scans->read(0);
  ASSERT_TRUE(reading.scan.has_value()) << reading.problem;
  EXPECT_EQ(reading.scan->stamp_fraction, 0.5);
  EXPECT_NEAR(reading.scan->points[0].sweep_fraction, 0.5,
              1e-6);  // straight ahead, half a turn after the start
}

TEST(PlainFolder, PointsAtTheOriginAreNoReturns) {
  const test::TempFolder folder;
  folder.write(
      "0.pcd",
      "VERSION 0.7\nFIELDS x y z time\nSIZE 4 4 4 8\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n5 1 0 0.0\n0 0 0 0.05\n5 2 0 0.1\n");
  const ScanReading reading = open_dataset(folder.path(), {}).scans->read(0);
  ASSERT_TRUE(reading.scan.has_value()) << reading.problem;
  EXPECT_EQ(reading.invalid_points, 1U);
  EXPECT_EQ(reading.scan->points.size(), 2U);
  EXPECT_THAT(fractions(*reading.scan), ElementsAre(0.0, 1.0));
}

TEST(PlainFolder, HasNoSequence) {
  const test::TempFolder folder;
  folder.write("0.bin", small_bin());
  EXPECT_THAT([&] { open_dataset(folder.path(), {.sequence = "3"}); },
              testing::ThrowsMessage<InputError>(HasSubstr("leave out --sequence")));
}

}  // namespace
}  // namespace mlo
