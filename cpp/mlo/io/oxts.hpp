#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"

namespace mlo {

/// One record of KITTI's inertial unit (OXTS RT3003), as far as it is used.
struct OxtsRecord {
  /// What records have beyond place and attitude.
  struct Motion {
    Eigen::Vector3d velocity_enu_m_s = Eigen::Vector3d::Zero();  ///< east, north, up
    Eigen::Vector3d rate_imu_rad_s = Eigen::Vector3d::Zero();    ///< about the IMU's axes
    double position_accuracy_m = 0.0;  ///< standard deviations, as the record has them
    double velocity_accuracy_m_s = 0.0;
  };

  std::size_t frame = 0;
  std::optional<double> stamp_s;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;
  Eigen::Vector3d roll_pitch_yaw_rad = Eigen::Vector3d::Zero();
  std::optional<Motion> motion;  ///< none where the line is too short
};

/// A file with one record per line; line i belongs to frame i. There are no stamps.
/// @throws InputError naming file and line if a line is something else
std::vector<OxtsRecord> read_oxts_file(const std::filesystem::path& file);

/// KITTI raw's oxts folder (data/NNNNNNNNNN.txt, timestamps.txt); frames are the numbers of the files. Stamps
/// are set if timestamps.txt has one for every record.
std::vector<OxtsRecord> read_oxts_records(const std::filesystem::path& folder);

/// Poses of the IMU (x ahead, y left, z up) in the Mercator projection at the first record's latitude, about
/// the first one's place: x east, y north, z up. As KITTI's development kit defines them.
std::vector<SE3> oxts_poses(std::span<const OxtsRecord> records);

}  // namespace mlo
