#pragma once

#include <filesystem>

#include "mlo/io/dataset.hpp"

namespace mlo {

/// Calibration of one file, of the odometry benchmark (calib.txt: P2, Tr) or of tracking and object detection
/// (calib/NNNN.txt: P2, R_rect or R0_rect, Tr_velo_cam or Tr_velo_to_cam, Tr_imu_velo or Tr_imu_to_velo).
/// What the file does not hold stays empty.
/// @throws InputError if the file cannot be read or a matrix in it has another number of entries
Calibration read_calibration_file(const std::filesystem::path& file);

/// Calibration of a date of KITTI raw: calib_velo_to_cam.txt, calib_cam_to_cam.txt, calib_imu_to_velo.txt.
/// What the folder does not hold stays empty.
/// @throws InputError if one of the files cannot be understood
Calibration read_raw_calibration(const std::filesystem::path& date_folder);

}  // namespace mlo
