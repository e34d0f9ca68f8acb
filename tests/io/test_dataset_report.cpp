#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/synthetic_sweep.hpp"
#include "mlo/io/dataset_report.hpp"
#include "real_data.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<Point> small_sweep(std::vector<int> absent_rings = {}) {
  return test::make_sweep(
      {.sensor = hdl64e(), .columns = 60, .dropout = 0.0, .absent_rings = std::move(absent_rings)});
}

void write_scan(const test::TempFolder& folder, int frame, const std::string& bytes) {
  folder.write(fmt::format("04/velodyne/{:06}.bin", frame), bytes);
}

TEST(SpreadOf, KnownAnswers) {
  const Spread spread = spread_of({3.0, 1.0, 2.0, 9.0, -4.0});
  EXPECT_EQ(spread.min, -4.0);
  EXPECT_EQ(spread.median, 2.0);
  EXPECT_EQ(spread.max, 9.0);
  EXPECT_EQ(spread_of({}).max, 0.0);
  EXPECT_EQ(spread_of({7.0}).min, 7.0);
}

TEST(ReportOn, AGoodSequence) {
  const test::TempFolder folder;
  std::string times;
  std::string poses;
  for (int frame = 0; frame < 5; ++frame) {
    write_scan(folder, frame, test::to_bin(small_sweep()));
    times += fmt::format("{}\n", 0.1 * frame + (frame > 2 ? 0.4 : 0.0));
    poses += fmt::format("1 0 0 {} 0 1 0 0 0 0 1 0\n", 2 * frame);
  }
  folder.write("04/times.txt", times);
  folder.write("04/poses.txt", poses);
  folder.write("04/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  const Dataset dataset = open_dataset(folder.path() / "04", {});
  const DatasetReport report = report_on(dataset, 0);
  EXPECT_EQ(report.scans, 5U);
  EXPECT_EQ(report.scans_read, 5U);
  EXPECT_EQ(report.last_frame, 4U);
  EXPECT_NEAR(report.duration_s, 0.8, 1e-9);
  EXPECT_NEAR(report.rate_hz, 10.0, 1e-6);
  ASSERT_EQ(report.gaps.size(), 1U);
  EXPECT_EQ(report.gaps[0].frame, 2U);
  EXPECT_NEAR(report.gaps[0].length_s, 0.5, 1e-9);
  EXPECT_EQ(report.points.min, 64.0 * 60.0);
  EXPECT_EQ(report.points.max, 64.0 * 60.0);
  EXPECT_EQ(report.rings.median, 64.0);
  EXPECT_LT(report.range_m.max, 24.0);  // the corner of the room
  EXPECT_GT(report.range_m.min, 3.0);   // the ground under the lowest beam
  EXPECT_NEAR(report.sweep_fraction.min, 0.5 / 60.0, 1e-4);
  EXPECT_TRUE(report.motion_compensated);
  EXPECT_EQ(report.poses, 5U);
  EXPECT_NEAR(report.path_m, 8.0, 1e-6);
  EXPECT_THAT(report.findings, IsEmpty());
}

TEST(ReportOn, FindsWhatIsWrong) {
  const test::TempFolder folder;
  std::vector<Point> some_nan = small_sweep();
  for (std::size_t i = 0; i < 100; ++i) some_nan[i].p_lidar.x() = std::numeric_limits<float>::quiet_NaN();
  std::vector<Point> sparse = small_sweep();
  std::erase_if(sparse, [n = 0](const Point&) mutable { return ++n % 3 != 0; });
  std::vector<int> lower_rings;
  for (int ring = 40; ring < 64; ++ring) lower_rings.push_back(ring);
  for (const int frame : {0, 1, 2, 3, 12}) write_scan(folder, frame, test::to_bin(small_sweep()));
  write_scan(folder, 4, "");
  write_scan(folder, 5, "not a multiple");
  write_scan(folder, 7, test::to_bin(some_nan));
  write_scan(folder, 8, test::to_bin(sparse));
  write_scan(folder, 9, test::to_bin(small_sweep(lower_rings)));
  folder.write("04/times.txt", "0\n0.1\n0.2\n0.3\n0.25\n0.5\n0.6\n0.7\n0.8\n0.9\n1.0\n1.1\n1.2\n");
  const DatasetReport report = report_on(open_dataset(folder.path() / "04", {}), 0);
  EXPECT_EQ(report.scans, 13U);
  EXPECT_EQ(report.scans_missing, 3U);
  EXPECT_EQ(report.scans_unreadable, 2U);
  EXPECT_EQ(report.invalid_points, 100U);
  EXPECT_THAT(report.findings, Contains(HasSubstr("not later than the one before: 1")));
  EXPECT_THAT(report.findings, Contains(HasSubstr("missing scans (3): frame 6, 10-11")));
  EXPECT_THAT(report.findings, Contains(HasSubstr("000004.bin: no valid point")));
  EXPECT_THAT(report.findings, Contains(HasSubstr("000005.bin: 14 bytes")));
  EXPECT_THAT(
      report.findings,
      Contains(HasSubstr("1 scan with over 1 % of their points NaN, infinite or at the origin: frame 7")));
  EXPECT_THAT(report.findings,
              Contains(HasSubstr("scan with fewer than half of the usual 3840 points: frame 8")));
  EXPECT_THAT(report.findings,
              Contains(HasSubstr("fewer than the usual 64 scan lines (an incomplete revolution?): frame 9")));
  EXPECT_EQ(report.findings.size(), 7U);
}

TEST(ReportOn, UnitsAndUnknownRings) {
  const test::TempFolder folder;
  std::vector<Point> millimetres = small_sweep();
  for (Point& point : millimetres) point.p_lidar *= 1000.0F;
  std::shuffle(millimetres.begin(), millimetres.end(), std::mt19937(1));
  folder.write("0.bin", test::to_bin(millimetres));
  folder.write("1.bin", test::to_bin(millimetres));
  folder.write("times.txt", "0\n100000\n");
  const DatasetReport report = report_on(open_dataset(folder.path(), {}), 0);
  EXPECT_EQ(report.rings.max, 0.0);
  EXPECT_THAT(report.findings, ElementsAre(HasSubstr("scan lines are unknown"), HasSubstr("in metres?"),
                                           HasSubstr("in seconds?")));
}

TEST(ReportOn, ASampleHasTheFirstAndTheLast) {
  const test::TempFolder folder;
  for (int frame = 0; frame < 9; ++frame) {
    write_scan(folder, frame, frame == 0 || frame == 8 ? "bad" : test::to_bin(small_sweep()));
  }
  const Dataset dataset = open_dataset(folder.path() / "04", {});
  for (const std::size_t max_scans : {2, 3, 4, 100}) {
    const DatasetReport report = report_on(dataset, max_scans);
    EXPECT_EQ(report.scans_read, std::min<std::size_t>(max_scans, 9));
    EXPECT_EQ(report.scans_unreadable, 2U);
  }
  EXPECT_EQ(report_on(dataset, 1).scans_read, 1U);
}

TEST(ReportOn, NothingReadable) {
  const test::TempFolder folder;
  for (int frame = 0; frame < 12; ++frame) write_scan(folder, frame, "bad");
  const DatasetReport report = report_on(open_dataset(folder.path() / "04", {}), 0);
  EXPECT_EQ(report.scans_unreadable, 12U);
  EXPECT_EQ(report.points.max, 0.0);
  EXPECT_THAT(report.findings, Contains(HasSubstr("2 more scans cannot be read")));
}

TEST(ReportOnDetections, CountsThoseOfTheScans) {
  const test::TempFolder folder;
  for (const int frame : {3, 4}) write_scan(folder, frame, test::to_bin(small_sweep()));
  const Dataset dataset = open_dataset(folder.path() / "04", {});
  DetectionList list;
  const DetectionRecord car;
  DetectionRecord cyclist;
  cyclist.detection.object_class = ObjectClass::cyclist;
  list.by_frame = {{0, {car}}, {4, {car, car, cyclist}}};
  const DetectionReport report = report_on_detections(dataset, list);
  EXPECT_EQ(report.boxes, 3U);
  EXPECT_EQ(report.scans, 1U);
  EXPECT_THAT(report.by_class, ElementsAre(testing::Pair("car", 2U), testing::Pair("cyclist", 1U)));
  EXPECT_EQ(report_on_detections(dataset, {}).boxes, 0U);
}

TEST(ReportOn, RealScansWithoutFindings) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const DatasetReport report = report_on(open_dataset(*data / "kitti_odometry", {.sequence = "04"}), 10);
  EXPECT_THAT(report.findings, IsEmpty());
  EXPECT_EQ(report.rings.min, 64.0);
  EXPECT_NEAR(report.path_m, 69.0, 1.0);
  EXPECT_NEAR(report.range_m.max, 80.0, 2.0);
}

}  // namespace
}  // namespace mlo
