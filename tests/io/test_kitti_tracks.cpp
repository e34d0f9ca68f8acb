#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using test::TempFolder;

constexpr const char* kCar = "3 7 Car 1 2 -1.5 10 20 110 70 1.5 1.6 4.0 2.0 1.7 20.0 0.0";
constexpr const char* kDontCare = "3 -1 DontCare -1 -1 -10 5 6 7 8 -1000 -1000 -1000 -10 -1 -1 -1";

TEST(KittiTracks, ReadsLabelsInLevelAxes) {
  const TempFolder folder;
  const auto records = read_kitti_tracks(folder.write("a.txt", std::string(kCar) + "\n" + kDontCare + "\n"));
  ASSERT_EQ(records.size(), 2U);
  const ObjectRecord& car = records[0];
  EXPECT_EQ(car.frame, 3U);
  EXPECT_EQ(car.track_id, 7);
  EXPECT_EQ(car.type, "car");
  EXPECT_EQ(car.truncation, 1);
  EXPECT_EQ(car.occlusion, 2);
  EXPECT_EQ(car.image_box.left_px, 10.0);
  EXPECT_EQ(car.image_box.bottom_px, 70.0);
  EXPECT_EQ(car.score, 1.0);
  // 20 m ahead, 2 m to the right, the bottom 1.7 m below the camera; rotation 0 heads to the right.
  EXPECT_TRUE(car.box.center_lidar_m.isApprox(Eigen::Vector3d(20.0, -2.0, -0.95), 1e-12));
  EXPECT_TRUE(car.box.size_lwh_m.isApprox(Eigen::Vector3d(4.0, 1.6, 1.5), 1e-12));
  const Eigen::Vector3d heading = car.box.T_lidar_object().rotation() * Eigen::Vector3d::UnitX();
  EXPECT_TRUE(heading.isApprox(-Eigen::Vector3d::UnitY(), 1e-12)) << heading.transpose();
  EXPECT_EQ(records[1].track_id, -1);
  EXPECT_EQ(records[1].type, "dontcare");
}

TEST(KittiTracks, RotationAboutTheCamerasYTurnsTheOtherWay) {
  const TempFolder folder;
  // Rotation -pi/2 heads ahead.
  const auto records = read_kitti_tracks(
      folder.write("a.txt", "0 1 Car 0 0 0 1 2 3 4 1.5 1.6 4 0 0 10 -1.5707963267948966 8.25\n"));
  const Eigen::Vector3d heading = records.at(0).box.T_lidar_object().rotation() * Eigen::Vector3d::UnitX();
  EXPECT_TRUE(heading.isApprox(Eigen::Vector3d::UnitX(), 1e-12)) << heading.transpose();
  EXPECT_EQ(records[0].score, 8.25);
}

TEST(KittiTracks, ReadsFoldersBySequenceAndSingleFiles) {
  const TempFolder folder;
  folder.write("tracks/0002.txt", kCar);
  folder.write("tracks/0000.txt", "");
  folder.write("tracks/readme.md", "not a track");
  const auto sequences = read_kitti_sequences(folder.path() / "tracks");
  ASSERT_EQ(sequences.size(), 2U);
  EXPECT_TRUE(sequences.at("0000").empty());
  EXPECT_EQ(sequences.at("0002").size(), 1U);
  EXPECT_EQ(read_kitti_sequences(folder.path() / "tracks" / "0002.txt").at("0002").size(), 1U);
}

TEST(KittiTracks, ProblemsNameFileAndLine) {
  const TempFolder folder;
  const auto problem = [&](const std::string& text) -> std::string {
    try {
      read_kitti_tracks(folder.write("bad.txt", std::string(kCar) + "\n" + text + "\n"));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  for (const char* line :
       {"3 7 Car 1 2 -1.5 10 20", "x 7 Car 1 2 -1.5 10 20 110 70 1.5 1.6 4.0 2.0 1.7 20.0 0.0",
        "-1 7 Car 1 2 -1.5 10 20 110 70 1.5 1.6 4.0 2.0 1.7 20.0 0.0",
        "1 7.5 Car 1 2 -1.5 10 20 110 70 1.5 1.6 4.0 2.0 1.7 20.0 0.0",
        "1 7 Car 1 2 -1.5 10 20 110 70 1.5 1.6 4.0 2.0 nan 20.0 0.0", "junk"}) {
    EXPECT_THAT(problem(line), testing::HasSubstr("bad.txt:2")) << line;
  }
  EXPECT_THROW(read_kitti_sequences(folder.path() / "absent"), InputError);
  std::filesystem::create_directory(folder.path() / "empty");
  EXPECT_THROW(read_kitti_sequences(folder.path() / "empty"), InputError);
}

TEST(KittiTracks, WritesWhatItReads) {
  const TempFolder folder;
  auto records = read_kitti_tracks(folder.write("a.txt", std::string(kCar) + " 0.75\n"));
  records.push_back(records.front());
  records.back().frame = 4;
  records.back().box.yaw_rad = 2.5;
  write_kitti_tracks(folder.path() / "b.txt", records);
  const auto back = read_kitti_tracks(folder.path() / "b.txt");
  ASSERT_EQ(back.size(), 2U);
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].frame, records[i].frame);
    EXPECT_EQ(back[i].track_id, records[i].track_id);
    EXPECT_EQ(back[i].type, "car");
    EXPECT_NEAR(back[i].score, 0.75, 1e-6);
    EXPECT_NEAR(back[i].image_box.right_px, records[i].image_box.right_px, 1e-3);
    EXPECT_TRUE(back[i].box.center_lidar_m.isApprox(records[i].box.center_lidar_m, 1e-5));
    EXPECT_NEAR(back[i].box.yaw_rad, records[i].box.yaw_rad, 1e-4);
  }
  write_kitti_tracks(folder.path() / "none.txt", {});
  EXPECT_TRUE(read_kitti_tracks(folder.path() / "none.txt").empty());
}

TEST(KittiObjectLabels, TruncationBecomesSteps) {
  const TempFolder folder;
  const std::string rest = " 2 -1.5 10 20 110 70 1.5 1.6 4.0 2.0 1.7 20.0 0.0\n";
  std::string text;
  for (const char* share : {"0.00", "0.15", "0.30", "0.45", "0.80"})
    text += std::string("Car ") + share + rest;
  text += "DontCare -1 -1 -10 5 6 7 8 -1 -1 -1 -1000 -1000 -1000 -10\n";
  const auto records = read_kitti_object_labels(folder.write("000001.txt", text));
  ASSERT_EQ(records.size(), 6U);
  const std::vector<int> steps{0, 0, 1, 2, 3};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(records[i].truncation, steps[i]);
    EXPECT_EQ(records[i].occlusion, 2);
    EXPECT_EQ(records[i].type, "car");
    EXPECT_GE(records[i].track_id, 0);
  }
  EXPECT_LT(records[5].track_id, 0);
  EXPECT_TRUE(records[0].box.center_lidar_m.isApprox(Eigen::Vector3d(20.0, -2.0, -0.95), 1e-12));
}

TEST(KittiObjectLabels, OtherColumnsAreRefused) {
  const TempFolder folder;
  EXPECT_THROW(read_kitti_object_labels(folder.write("a.txt", std::string(kCar) + "\n")), InputError);
  EXPECT_THROW(read_kitti_object_labels(
                   folder.write("b.txt", "Car x 2 -1.5 10 20 110 70 1.5 1.6 4.0 2.0 1.7 20.0 0.0\n")),
               InputError);
  EXPECT_THROW(read_kitti_object_labels(folder.path() / "none.txt"), InputError);
  EXPECT_TRUE(read_kitti_object_labels(folder.write("empty.txt", "")).empty());
}

}  // namespace
}  // namespace mlo
