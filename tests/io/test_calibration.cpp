#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/calibration.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// A camera looks along x of the lidar: x right is -y, y down is -z, z ahead is x.
constexpr const char* kAxes = "0 -1 0 0.1 0 0 -1 -0.2 1 0 0 -0.3";
constexpr const char* kQuarterTurnAboutZ = "0 -1 0 1 0 0 0 0 1";

TEST(ReadCalibrationFile, OdometryTrLeadsToTheRectifiedCamera) {
  const test::TempFolder folder;
  const auto file =
      folder.write("calib.txt", std::string("P0: 1 0 0 0 0 1 0 0 0 0 1 0\nP2: 700 0 600 45 0 700 180 "
                                            "-0.3 0 0 1 0.005\nTr: ") +
                                    kAxes + "\n");
  const Calibration calibration = read_calibration_file(file);
  ASSERT_TRUE(calibration.T_camera0_lidar && calibration.P2);
  EXPECT_TRUE((*calibration.T_camera0_lidar * Eigen::Vector3d(10.0, 2.0, 1.0))
                  .isApprox(Eigen::Vector3d(-1.9, -1.2, 9.7), 1e-12));
  EXPECT_EQ((*calibration.P2)(0, 3), 45.0);
  EXPECT_EQ((*calibration.P2)(1, 1), 700.0);
  EXPECT_FALSE(calibration.T_imu_lidar.has_value());
}

TEST(ReadCalibrationFile, BothSpellingsOfTracking) {
  const test::TempFolder folder;
  for (const bool new_spelling : {true, false}) {
    const std::string colon = new_spelling ? ": " : " ";
    const std::string text = (new_spelling ? "R0_rect" : "R_rect") + colon + kQuarterTurnAboutZ + "\n" +
                             (new_spelling ? "Tr_velo_to_cam" : "Tr_velo_cam") + colon + kAxes + " \n" +
                             (new_spelling ? "Tr_imu_to_velo" : "Tr_imu_velo") + colon +
                             "1 0 0 -0.8 0 1 0 0.3 0 0 1 -0.8\n\n";
    const Calibration calibration = read_calibration_file(folder.write("0000.txt", text));
    ASSERT_TRUE(calibration.T_camera0_lidar && calibration.T_imu_lidar);
    // Rectification turns the camera's (-1.9, -1.2, 9.7) by 90 degrees about z.
    EXPECT_TRUE((*calibration.T_camera0_lidar * Eigen::Vector3d(10.0, 2.0, 1.0))
                    .isApprox(Eigen::Vector3d(1.2, -1.9, 9.7), 1e-12));
    EXPECT_TRUE(
        (*calibration.T_imu_lidar * Eigen::Vector3d::Zero()).isApprox(Eigen::Vector3d(0.8, -0.3, 0.8)));
    EXPECT_FALSE(calibration.P2.has_value());
  }
}

TEST(ReadRawCalibration, CombinesThreeFiles) {
  const test::TempFolder folder;
  folder.write("calib_velo_to_cam.txt",
               "calib_time: 15-Mar-2012 11:37:16\nR: 0 -1 0 0 0 -1 1 0 0\nT: 0.1 -0.2 -0.3\n");
  folder.write("calib_cam_to_cam.txt", std::string("corner_dist: 9.95e-02\nR_rect_00: ") +
                                           kQuarterTurnAboutZ +
                                           "\nP_rect_02: 700 0 600 45 0 700 180 -0.3 0 0 1 0.005\n");
  folder.write("calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.8\n");
  const Calibration calibration = read_raw_calibration(folder.path());
  ASSERT_TRUE(calibration.T_camera0_lidar && calibration.T_imu_lidar && calibration.P2);
  EXPECT_TRUE((*calibration.T_camera0_lidar * Eigen::Vector3d(10.0, 2.0, 1.0))
                  .isApprox(Eigen::Vector3d(1.2, -1.9, 9.7), 1e-12));
  EXPECT_TRUE(calibration.T_imu_lidar->translation().isApprox(Eigen::Vector3d(0.8, -0.3, 0.8)));
  EXPECT_EQ((*calibration.P2)(0, 2), 600.0);
}

TEST(ReadRawCalibration, AnEmptyFolderHasNone) {
  const test::TempFolder folder;
  const Calibration calibration = read_raw_calibration(folder.path());
  EXPECT_FALSE(calibration.T_camera0_lidar || calibration.T_imu_lidar || calibration.P2);
}

TEST(ReadCalibrationFile, TellsFileLineAndRemedy) {
  const test::TempFolder folder;
  const auto open = [&](const char* text) { return read_calibration_file(folder.write("calib.txt", text)); };
  EXPECT_THAT([&] { open("P0: 1\nTr: 1 2 3\n"); },
              ThrowsMessage<InputError>(HasSubstr("calib.txt:2: 3 numbers for Tr, 12 are needed")));
  EXPECT_THAT([&] { open("Tr: 1 0 0 0 0 1 0 0 0 0 1 x\n"); },
              ThrowsMessage<InputError>(HasSubstr("calib.txt:1: 'x' is not a finite number")));
  EXPECT_FALSE(open("").T_camera0_lidar.has_value());
  EXPECT_THROW(read_calibration_file(folder.path() / "none.txt"), InputError);
}

}  // namespace
}  // namespace mlo
