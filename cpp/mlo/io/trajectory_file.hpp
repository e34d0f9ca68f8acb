#pragma once

#include <filesystem>
#include <string>

#include "mlo/io/dataset.hpp"

namespace mlo {

/// Reads poses from a text file; the format shows in the number of values a row has:
///  - 12, KITTI: the upper 3x4 of the pose's matrix row by row. Rows are numbered from 0 as frames; no
///  stamps.
///  - 8, TUM: stamp [s], translation [m], quaternion qx qy qz qw. Rows are numbered from 0 as frames.
/// Lines of TUM files that are blank or begin with # are skipped. A file without rows gives no poses.
/// @throws InputError naming file and line: another number of values, no finite number, no rotation
PoseList read_trajectory(const std::filesystem::path& path);

/// Writes KITTI rows, with the shortest digits that read back as the same doubles.
/// @throws InputError if the file cannot be written
void write_kitti_poses(const std::filesystem::path& path, const PoseList& poses);

/// Writes TUM rows, with the shortest digits that read back as the same doubles; qw is not negative.
/// @throws InputError if there is not one stamp per pose, or the file cannot be written
void write_tum_poses(const std::filesystem::path& path, const PoseList& poses);

/// One row without line end: the 12 numbers of the upper 3x4 matrix, or stamp [s] tx ty tz [m] qx qy qz qw.
std::string kitti_row(const SE3& pose);
std::string tum_row(double stamp_s, const SE3& pose);

}  // namespace mlo
