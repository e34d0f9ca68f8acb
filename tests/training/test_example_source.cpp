#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/training/example_source.hpp"
#include "real_data.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCalibration =
    "P2: 700 0 621 0 0 700 187 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n"
    "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";

/// A scan with points at 15 m ahead, in a car, and as many behind.
std::string scan_bytes() {
  std::string bytes;
  for (int i = 0; i < 10; ++i) {
    for (const float sign : {1.0F, -1.0F}) {
      const float point[] = {sign * (14.0F + 0.2F * static_cast<float>(i)), 0.1F, -1.0F, 0.5F};
      bytes.append(reinterpret_cast<const char*>(point), sizeof(point));
    }
  }
  return bytes;
}

/// The KITTI object benchmark with some of its scans, one of which has labels.
void write_object_benchmark(const test::TempFolder& folder) {
  folder.write("training/velodyne/000003.bin", scan_bytes());
  folder.write("training/velodyne/007000.bin", scan_bytes());
  folder.write("training/velodyne/000007.bin", scan_bytes());
  folder.write("training/calib/000007.txt", kCalibration);
  folder.write("training/label_2/000007.txt",
               "Car 0.40 1 0.0 600 150 640 200 1.5 1.8 4.2 0.0 1.7 15.0 -1.5708\n"
               "DontCare -1 -1 -10 500 150 520 160 -1 -1 -1 -1000 -1000 -1000 -10\n");
}

TEST(OpenExamples, KittiObjectBenchmark) {
  const test::TempFolder folder;
  write_object_benchmark(folder);
  for (const fs::path& path : {folder.path(), folder.path() / "training"}) {
    const auto source = open_examples(path);
    ASSERT_EQ(source->size(), 1U);
    const ExampleReading reading = source->read(0);
    ASSERT_TRUE(reading.example) << reading.problem;
    const TrainingExample& example = *reading.example;
    ASSERT_EQ(example.boxes.size(), 1U);
    const TrainingBox& car = example.boxes[0];
    EXPECT_EQ(car.object_class, ObjectClass::car);
    EXPECT_TRUE(car.box.center_lidar_m.isApprox(Eigen::Vector3d(15.0, 0.0, -0.95), 1e-3));
    EXPECT_NEAR(car.box.yaw_rad, 0.0, 1e-3);
    EXPECT_EQ(car.truncation, 2);
    EXPECT_EQ(car.occlusion, 1);
    EXPECT_EQ(car.height_px, 50.0);
    EXPECT_EQ(car.points, 10U);
    EXPECT_EQ(example.points.size(), 10U);  // those ahead
    EXPECT_TRUE(example.view);
    EXPECT_NE(example.name.find("scan 7"), std::string::npos);
  }
}

TEST(OpenExamples, DemandsAsManyPointsAsAsked) {
  const test::TempFolder folder;
  write_object_benchmark(folder);
  EXPECT_TRUE(open_examples(folder.path(), {.min_points = 10})->read(0).example->boxes[0].demanded);
  EXPECT_FALSE(open_examples(folder.path(), {.min_points = 11})->read(0).example->boxes[0].demanded);
}

TEST(OpenExamples, SaysWhatIsWrong) {
  const test::TempFolder folder;
  write_object_benchmark(folder);
  folder.write("training/velodyne/000007.bin", "123");
  const ExampleReading broken = open_examples(folder.path())->read(0);
  EXPECT_FALSE(broken.example);
  EXPECT_NE(broken.problem.find("000007.bin"), std::string::npos);
  folder.write("training/velodyne/000007.bin", scan_bytes());
  folder.write("training/label_2/000007.txt", "Car 0.40 1\n");
  EXPECT_THROW(open_examples(folder.path())->read(0), InputError);
  fs::remove(folder.path() / "training/label_2/000007.txt");
  EXPECT_THROW(open_examples(folder.path()), InputError);
}

TEST(OpenExamples, RefusesFoldersWithoutLabels) {
  const test::TempFolder folder;
  folder.write("scans/000000.bin", scan_bytes());
  EXPECT_THROW(open_examples(folder.path() / "scans"), InputError);
  EXPECT_THROW(open_examples(folder.path() / "none"), InputError);
}

TEST(OpenExamples, RefusesLabelsWithoutCalibration) {
  const test::TempFolder folder;
  folder.write("velodyne/0004/000000.bin", scan_bytes());
  folder.write("label_02/0004.txt", "0 0 Car 0 0 0 600 150 640 200 1.5 1.8 4.2 0 1.7 15 -1.57\n");
  EXPECT_THROW(open_examples(folder.path()), InputError);
}

TEST(OpenExamples, KittiTrackingFromTheFirstLabelToTheLast) {
  const test::TempFolder folder;
  for (const char* name : {"000000", "000001", "000002", "000003", "000004"}) {
    folder.write(fs::path("velodyne/0004") / (std::string(name) + ".bin"), scan_bytes());
  }
  folder.write("calib/0004.txt", kCalibration);
  folder.write("label_02/0004.txt",
               "1 0 Car 0 0 0 600 150 640 200 1.5 1.8 4.2 0 1.7 15 -1.5708\n"
               "3 0 Car 0 0 0 600 150 640 200 1.5 1.8 4.2 0 1.7 15 -1.5708\n");
  const auto source = open_examples(folder.path());
  ASSERT_EQ(source->size(), 3U);
  EXPECT_EQ(source->read(0).example->boxes.size(), 1U);
  EXPECT_EQ(source->read(1).example->boxes.size(), 0U);
  EXPECT_EQ(source->read(2).example->boxes.size(), 1U);
}

TEST(OpenExamples, RealTrackingSequence) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  if (!fs::exists(*data / "kitti_tracking/training/label_02/0000.txt")) {
    GTEST_SKIP() << "KITTI tracking sequence 0000 is absent";
  }
  const auto source = open_examples(*data / "kitti_tracking/training/velodyne/0000");
  ASSERT_GT(source->size(), 10U);
  std::size_t demanded = 0;
  std::size_t vans = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    const ExampleReading reading = source->read(i);
    ASSERT_TRUE(reading.example) << reading.problem;
    ASSERT_TRUE(reading.example->view);
    EXPECT_GT(reading.example->points.size(), 10000U);
    EXPECT_LT(reading.example->points.size(), 40000U);  // of about 120000
    for (const TrainingBox& label : reading.example->boxes) {
      demanded += label.demanded ? 1U : 0U;
      vans += label.object_class == ObjectClass::van ? 1U : 0U;
      if (label.box.center_lidar_m.norm() > 25.0 || label.occlusion > 0 || label.truncation > 0) continue;
      EXPECT_GT(label.points, 20U);
    }
  }
  EXPECT_GT(demanded, 10U);
  EXPECT_GE(vans, 10U);  // one is there all the time
}

TEST(OpenExamples, RealTrackletsOfARawDrive) {
  const auto data = test::real_data();
  const fs::path drive = "kitti_raw/2011_09_26/2011_09_26_drive_0005_sync";
  if (!data) GTEST_SKIP() << test::kNoRealData;
  if (!fs::exists(*data / drive / "tracklet_labels.xml"))
    GTEST_SKIP() << "the tracklets of drive 0005 are absent";
  const auto source = open_examples(*data / drive);
  const ExampleReading reading = source->read(0);
  ASSERT_TRUE(reading.example) << reading.problem;
  ASSERT_FALSE(reading.example->boxes.empty());
  EXPECT_TRUE(std::ranges::any_of(reading.example->boxes, [](const TrainingBox& label) {
    return label.demanded && label.height_px > 25.0;
  }));
}

}  // namespace
}  // namespace mlo
