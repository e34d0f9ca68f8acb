#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/synthetic_sweep.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/dataset.hpp"
#include "real_data.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string small_scan() {
  return test::to_bin(test::make_sweep({.sensor = hdl64e(), .columns = 60}));
}

// Frames of a source, and which of them can be read.
std::vector<std::size_t> frames(const ScanSource& scans) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < scans.size(); ++i) result.push_back(scans.frame(i));
  return result;
}

TEST(OpenDataset, KittiOdometryFromEveryLevel) {
  const test::TempFolder folder;
  folder.write("dataset/sequences/04/velodyne/000000.bin", small_scan());
  folder.write("dataset/sequences/04/velodyne/000001.bin", small_scan());
  folder.write("dataset/sequences/04/times.txt", "0.0\n1.037e-01\n2.1e-01\n");
  for (const char* level :
       {"", "dataset", "dataset/sequences", "dataset/sequences/04", "dataset/sequences/04/"}) {
    const Dataset dataset = open_dataset(folder.path() / level, {});
    EXPECT_EQ(dataset.format, "kitti_odometry") << level;
    EXPECT_EQ(dataset.sequence, "04");
    EXPECT_EQ(dataset.sensor.vertical_correction_deg, 0.205);
    EXPECT_THAT(dataset.warnings, IsEmpty());
    ASSERT_EQ(dataset.scans->size(), 2U);
    const ScanReading reading = dataset.scans->read(1);
    ASSERT_TRUE(reading.scan.has_value()) << reading.problem;
    EXPECT_EQ(reading.scan->frame, 1U);
    EXPECT_EQ(reading.scan->stamp_s, 0.1037);
    EXPECT_TRUE(reading.scan->motion_compensated);
    EXPECT_EQ(reading.scan->stamp_fraction, 0.5);
    EXPECT_EQ(reading.scan->points.front().ring, 0);
    EXPECT_EQ(reading.scan->points.back().ring, 63);
  }
}

TEST(OpenDataset, KittiRawFromEveryLevel) {
  const test::TempFolder folder;
  const std::string drive = "kitti/2011_09_26/2011_09_26_drive_0005_sync";
  const std::string date = "2011-09-26 13:04:";
  folder.write(drive + "/velodyne_points/data/0000000003.bin", small_scan());
  folder.write(drive + "/velodyne_points/timestamps.txt",
               "\n\n\n" + date + "32.335337762\n" + date + "32.44\n");
  folder.write(drive + "/velodyne_points/timestamps_start.txt",
               "\n\n\n" + date + "32.25\n" + date + "32.35\n");
  folder.write(drive + "/velodyne_points/timestamps_end.txt",
               "\n\n\n" + date + "32.375\n" + date + "32.45\n");
  for (const std::string& level : {std::string("kitti"), std::string("kitti/2011_09_26"), drive}) {
    const Dataset dataset = open_dataset(folder.path() / level, {});
    EXPECT_EQ(dataset.format, "kitti_raw") << level;
    EXPECT_EQ(dataset.sequence, "2011_09_26_drive_0005_sync");
    EXPECT_EQ(dataset.sensor.vertical_correction_deg, 0.205);
    EXPECT_THAT(frames(*dataset.scans), ElementsAre(3U));
    const ScanReading reading = dataset.scans->read(0);
    ASSERT_TRUE(reading.scan.has_value()) << reading.problem;
    EXPECT_FALSE(reading.scan->motion_compensated);
    EXPECT_NEAR(reading.scan->stamp_s, 1317042272.335337762, 1e-6);
    EXPECT_NEAR(reading.scan->duration_s, 0.125, 1e-6);
    EXPECT_EQ(reading.scan->stamp_fraction, 0.5);
  }
}

TEST(OpenDataset, KittiTrackingFromEveryLevel) {
  const test::TempFolder folder;
  folder.write("t/training/velodyne/0001/000176.bin", small_scan());
  folder.write("t/training/velodyne/0001/000181.bin", small_scan());
  folder.write("t/training/calib/0001.txt", "Tr_imu_velo 1 0 0 -0.8 0 1 0 0.3 0 0 1 -0.8\n");
  std::string rows;
  for (int frame = 0; frame < 200; ++frame) rows += "1 0 0 " + std::to_string(frame) + " 0 1 0 0 0 0 1 0\n";
  folder.write("t/training/poses_imu/0001.txt", rows);
  folder.write("t/training/label_02/0001.txt", "");
  for (const char* level : {"t", "t/training", "t/training/velodyne", "t/training/velodyne/0001"}) {
    const Dataset dataset = open_dataset(folder.path() / level, {});
    EXPECT_EQ(dataset.format, "kitti_tracking") << level;
    EXPECT_EQ(dataset.sequence, "0001");
    EXPECT_THAT(frames(*dataset.scans), ElementsAre(176U, 177U, 178U, 179U, 180U, 181U));
    EXPECT_THAT(dataset.scans->read(1).problem, HasSubstr("000177.bin: the scan is missing"));
    EXPECT_EQ(dataset.labels, folder.path() / "t/training/label_02/0001.txt");
    ASSERT_TRUE(dataset.truth.has_value());
    EXPECT_EQ(dataset.truth->frames.front(), 176U);
    EXPECT_NEAR(dataset.truth->T_world_body.back().translation().x(), 5.0, 1e-9);
    const ScanReading reading = dataset.scans->read(5);
    ASSERT_TRUE(reading.scan.has_value()) << reading.problem;
    EXPECT_FALSE(reading.scan->motion_compensated);
    EXPECT_NEAR(reading.scan->stamp_s, 18.1, 1e-9);
  }
}

TEST(OpenDataset, AsksWhichOfSeveralSequences) {
  const test::TempFolder folder;
  for (const char* drive : {"2011_09_26_drive_0005_sync", "2011_09_26_drive_0009_sync"}) {
    folder.write(std::string("2011_09_26/") + drive + "/velodyne_points/data/0000000000.bin", small_scan());
  }
  const auto open = [&](const std::string& sequence) {
    return open_dataset(folder.path(), {.sequence = sequence}).sequence;
  };
  EXPECT_EQ(open("0009"), "2011_09_26_drive_0009_sync");
  EXPECT_EQ(open("5"), "2011_09_26_drive_0005_sync");
  EXPECT_EQ(open("2011_09_26_drive_0005_sync"), "2011_09_26_drive_0005_sync");
  EXPECT_THAT([&] { open(""); }, testing::ThrowsMessage<InputError>(HasSubstr("drive_0009_sync")));
  EXPECT_THAT([&] { open("7"); }, testing::ThrowsMessage<InputError>(HasSubstr("no sequence '7'")));
}

TEST(OpenDataset, TellsWhatItLookedFor) {
  const test::TempFolder folder;
  EXPECT_THAT([&] { open_dataset(folder.path(), {}); },
              testing::ThrowsMessage<InputError>(HasSubstr("velodyne_points")));
  EXPECT_THAT([&] { open_dataset(folder.path() / "none", {}); },
              testing::ThrowsMessage<InputError>(HasSubstr("is not a folder")));
  EXPECT_THAT([&] { open_dataset(folder.path(), {.format = "kiti"}); },
              testing::ThrowsMessage<InputError>(HasSubstr("kitti_odometry")));
}

TEST(OpenDataset, BadScansAreReadAsProblems) {
  const test::TempFolder folder;
  std::vector<Point> nan_points(100);
  for (Point& point : nan_points) point.p_lidar.setConstant(std::numeric_limits<float>::quiet_NaN());
  folder.write("04/velodyne/000000.bin", small_scan());
  folder.write("04/velodyne/000001.bin", "");
  folder.write("04/velodyne/000002.bin", small_scan().substr(0, 16 * 100 + 5));
  folder.write("04/velodyne/000003.bin", test::to_bin(nan_points));
  folder.write("04/velodyne/000005.bin", small_scan());
  const Dataset dataset = open_dataset(folder.path() / "04", {});
  EXPECT_THAT(frames(*dataset.scans), ElementsAre(0U, 1U, 2U, 3U, 4U, 5U));
  EXPECT_TRUE(dataset.scans->read(0).scan.has_value());
  EXPECT_THAT(dataset.scans->read(1).problem, HasSubstr("no valid point"));
  EXPECT_THAT(dataset.scans->read(2).problem, HasSubstr("1605 bytes"));
  EXPECT_THAT(dataset.scans->read(3).problem, HasSubstr("no valid point"));
  EXPECT_EQ(dataset.scans->read(3).invalid_points, 100U);
  EXPECT_THAT(dataset.scans->read(4).problem, HasSubstr("000004.bin: the scan is missing"));
  EXPECT_TRUE(dataset.scans->read(5).scan.has_value());
  for (std::size_t i = 1; i < 5; ++i) EXPECT_FALSE(dataset.scans->read(i).scan.has_value());
}

TEST(OpenDataset, StampsThatAreMissingOrUnsorted) {
  const test::TempFolder folder;
  for (const char* name : {"000000", "000001", "000002", "000003"}) {
    folder.write(std::string("04/velodyne/") + name + ".bin", small_scan());
  }
  folder.write("04/times.txt", "0.0\n0.1\n\n");
  const Dataset short_times = open_dataset(folder.path() / "04", {});
  EXPECT_THAT(short_times.warnings, ElementsAre(HasSubstr("no time for 2 of 4 scans")));
  EXPECT_NEAR(short_times.scans->read(3).scan->stamp_s, 0.3, 1e-12);

  folder.write("04/times.txt", "0.0\n0.2\n0.1\n0.3\n");
  EXPECT_THAT(open_dataset(folder.path() / "04", {}).warnings, ElementsAre(HasSubstr("not later")));

  folder.write("04/times.txt", "0.0\nyesterday\n");
  EXPECT_THAT([&] { open_dataset(folder.path() / "04", {}); },
              testing::ThrowsMessage<InputError>(HasSubstr("times.txt:2")));
}

TEST(RealDatasets, OpenWithTheirStampsAndGaps) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const Dataset odometry = open_dataset(*data / "kitti_odometry", {.sequence = "01"});
  EXPECT_EQ(odometry.scans->size(), 77U);
  EXPECT_THAT(odometry.warnings, IsEmpty());
  EXPECT_NEAR(odometry.scans->read(1).scan->stamp_s, 0.1037595, 1e-6);
  const Dataset raw = open_dataset(*data / "kitti_raw", {.sequence = "9"});
  EXPECT_EQ(raw.scans->size(), 51U);
  EXPECT_THAT(raw.warnings, IsEmpty());
  EXPECT_NEAR(raw.scans->read(50).scan->duration_s, 0.1033, 0.001);
  const Dataset tracking = open_dataset(*data / "kitti_tracking", {.sequence = "0000"});
  EXPECT_EQ(tracking.scans->size(), 154U);
  EXPECT_THAT(tracking.warnings, IsEmpty());
  ASSERT_TRUE(tracking.truth.has_value());
  EXPECT_EQ(tracking.truth->frames.size(), 154U);
}

}  // namespace
}  // namespace mlo
