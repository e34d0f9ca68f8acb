#pragma once

#include <filesystem>
#include <vector>

#include "mlo/io/dataset.hpp"
#include "mlo/io/sequence_files.hpp"

namespace mlo {

/// Sequences of the KITTI tracking benchmark in a folder: its root (the training part), `training` or
/// `testing`, or one sequence (velodyne/NNNN).
std::vector<SequenceFolder> find_kitti_tracking(const std::filesystem::path& folder);

/// Scans are as measured, like those of KITTI raw; the benchmark has no times, so that stamps are frames at
/// 10 Hz. Truth comes from oxts/NNNN.txt, or from poses_imu/NNNN.txt (rows of IMU poses) where only that is
/// there.
/// @throws InputError if a file that is there cannot be understood
Dataset open_kitti_tracking(const SequenceFolder& sequence, const OpenOptions& options);

}  // namespace mlo
