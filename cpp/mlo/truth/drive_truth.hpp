#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mlo/io/dataset.hpp"
#include "mlo/truth/oxts_smoother.hpp"

namespace mlo {

/// Poses of the lidar with what is known of their errors.
struct LidarTruth {
  PoseList poses;  ///< T_map_lidar with frames and stamps; the map frame is the lidar's at the first scan
  /// Of a perturbation [translation; rotation] ([m], [rad]) at the lidar's origin with the map's axes, of the
  /// pose in the drive's world: the first is not zero.
  std::vector<SmoothedPose::Matrix6d> covariances;
};

struct DriveTruth {
  LidarTruth at_stamps;  ///< of the scans
  LidarTruth at_middle;  ///< halfway between start and end of each sweep, in the same map frame
};

/// Smoothed ground truth of a drive from its inertial records (KITTI raw and tracking).
/// @throws InputError if the data has no usable records or no calibration between IMU and lidar
DriveTruth smooth_drive(const Dataset& dataset, const OxtsSmootherOptions& options = {});

/// Rows: frame, stamp_s, then the upper triangle of each covariance row by row, under a header line.
/// @throws InputError if the file cannot be written
void write_covariances(const std::filesystem::path& file, const LidarTruth& truth);

}  // namespace mlo
