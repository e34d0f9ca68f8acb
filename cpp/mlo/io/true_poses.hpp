#pragma once

#include <filesystem>

#include "mlo/io/dataset.hpp"

namespace mlo {

/// True poses as users give them: a file of KITTI or TUM rows, or an oxts folder of KITTI raw.
/// @param calibration  brings them to the lidar: a calibration file of KITTI odometry or tracking for camera
/// poses,
///   the folder of the date for oxts; empty: they stay those of the body that the file is about
/// @throws InputError if one cannot be read, or the calibration is about another body
PoseList read_true_poses(const std::filesystem::path& truth, const std::filesystem::path& calibration);

}  // namespace mlo
