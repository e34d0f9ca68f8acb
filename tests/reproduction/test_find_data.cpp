#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/reproduction/find_data.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

TEST(FindData, DrivesHaveThePapersNames) {
  EXPECT_EQ(paper_name_of_drive("2011_09_26_drive_0005_sync"), "0926-0005");
  EXPECT_EQ(paper_name_of_drive("2011_09_29_drive_0071_extract"), "0929-0071");
  EXPECT_FALSE(paper_name_of_drive("2011_09_26"));
  EXPECT_FALSE(paper_name_of_drive(""));
}

TEST(FindData, FindsTheThreeBenchmarks) {
  const test::TempFolder folder;
  folder.write("odometry/dataset/sequences/04/velodyne/000000.bin", "");
  folder.write("odometry/dataset/sequences/04/times.txt", "0\n");
  folder.write("raw/2011_09_26/2011_09_26_drive_0005_sync/velodyne_points/data/0000000000.bin", "");
  folder.write("tracking/training/velodyne/0001/000000.bin", "");
  folder.write("tracking/training/label_02/0001.txt", "");
  folder.write("tracking/training/calib/0001.txt", "");
  folder.write("tracking/training/detections/pointrcnn_car/0001.txt", "");
  const KittiData data = find_kitti(folder.path());
  EXPECT_THAT(data.odometry, testing::ElementsAre(testing::Key("04")));
  EXPECT_THAT(data.raw, testing::ElementsAre(testing::Key("0926-0005")));
  EXPECT_THAT(data.tracking, testing::ElementsAre(testing::Key("0001")));
  EXPECT_EQ(data.labels, folder.path() / "tracking/training/label_02");
  EXPECT_EQ(data.calibration, folder.path() / "tracking/training/calib");
  EXPECT_EQ(data.car_detections, folder.path() / "tracking/training/detections/pointrcnn_car");
}

TEST(FindData, DrivesHaveTheNumbersOfTheirTrackingSequences) {
  EXPECT_EQ(tracking_sequence_of("0926-0005"), "0000");
  EXPECT_EQ(tracking_sequence_of("0926-0018"), "0006");
  EXPECT_EQ(tracking_sequence_of("0926-0084"), std::nullopt);  // not part of the benchmark's training
  EXPECT_EQ(tracking_sequence_of("0929-0005"), std::nullopt);  // another day
}

TEST(FindData, NothingInAnEmptyFolder) {
  const test::TempFolder folder;
  const KittiData data = find_kitti(folder.path());
  EXPECT_TRUE(data.odometry.empty() && data.raw.empty() && data.tracking.empty());
  EXPECT_FALSE(data.labels || data.car_detections);
}

}  // namespace
}  // namespace mlo
