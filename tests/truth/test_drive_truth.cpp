#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/text_records.hpp"
#include "mlo/truth/drive_check.hpp"
#include "mlo/truth/drive_truth.hpp"
#include "mlo/truth/object_truth.hpp"
#include "real_data.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

constexpr const char* kDrive = "kitti_raw/2011_09_26/2011_09_26_drive_0005_sync";

PoseList first_of(PoseList poses, std::size_t count) {
  count = std::min(count, poses.frames.size());
  poses.frames.resize(count);
  poses.stamps_s.resize(count);
  poses.T_world_body.resize(count);
  return poses;
}

TEST(DriveTruth, ScansOfARealDriveAgreeBetterThanByRawRecords) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const Dataset dataset = open_dataset(*data / kDrive, {});
  const DriveTruth truth = smooth_drive(dataset);
  ASSERT_EQ(truth.at_stamps.poses.frames.size(), dataset.scans->size());
  ASSERT_TRUE(dataset.truth);
  constexpr std::size_t kScans = 40;
  for (const std::size_t lag : {1U, 5U}) {
    const DriveConsistency raw = check_drive(dataset, first_of(*dataset.truth, kScans), lag);
    const DriveConsistency smoothed = check_drive(dataset, first_of(truth.at_stamps.poses, kScans), lag);
    EXPECT_GT(smoothed.residuals, 50000U);
    EXPECT_LT(smoothed.median_m.value(), 0.95 * raw.median_m.value()) << lag << " scans apart";
    EXPECT_LT(smoothed.mean_m.value(), 0.95 * raw.mean_m.value()) << lag << " scans apart";
  }
}

TEST(DriveTruth, AnnotationsOfARealDriveBecomeObjects) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const Dataset dataset = open_dataset(*data / kDrive, {});
  const DriveTruth truth = smooth_drive(dataset);
  const auto boxes = read_tracklets(*data / kDrive / "tracklet_labels.xml");
  const std::vector<ObjectPose> objects = objects_in_map(boxes, truth.at_stamps.poses);
  EXPECT_EQ(objects.size(), boxes.size());
  EXPECT_THAT(objects, testing::Each(testing::Field(&ObjectPose::stamp_s, testing::Ne(std::nullopt))));
}

TEST(DriveTruth, WithoutRecordsOrCalibrationTheRemedyIsNamed) {
  const test::TempFolder folder;
  folder.write("training/velodyne/0000/000000.bin", std::string(32, 'a'));
  const auto problem_of = [&] {
    try {
      smooth_drive(open_dataset(folder.path(), {.sequence = "0000"}));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(problem_of(), testing::HasSubstr("calibration"));
  folder.write(
      "training/calib/0000.txt",
      "P2: 1 0 0 0 0 1 0 0 0 0 1 0\nR_rect 1 0 0 0 1 0 0 0 1\nTr_velo_cam 0 -1 0 0 0 0 -1 0 1 0 0 0\n"
      "Tr_imu_velo 1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(problem_of(), testing::HasSubstr("no inertial records"));
  folder.write("training/oxts/0000.txt", "49 8 100 0 0 0\n");  // places, but no velocities
  EXPECT_THAT(problem_of(), testing::HasSubstr("velocities"));
}

TEST(DriveTruth, CovariancesAreWrittenAsAnUpperTriangle) {
  const test::TempFolder folder;
  LidarTruth truth;
  truth.poses.frames = {4};
  truth.poses.stamps_s = {0.5};
  truth.poses.T_world_body.emplace_back();
  truth.covariances.emplace_back(SmoothedPose::Matrix6d::Identity() * 0.25);
  write_covariances(folder.path() / "covariance.csv", truth);
  const auto lines = read_lines(folder.path() / "covariance.csv");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_THAT(lines[0], testing::StartsWith("frame,stamp_s,x_x,x_y"));
  EXPECT_THAT(lines[0], testing::EndsWith("ry_ry,ry_rz,rz_rz"));
  EXPECT_THAT(lines[1], testing::StartsWith("4,0.500000,2.5"));
  EXPECT_EQ(std::count(lines[1].begin(), lines[1].end(), ','), 22);
}

}  // namespace
}  // namespace mlo
