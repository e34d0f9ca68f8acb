#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mlo/core/se3.hpp"
#include "mlo/io/dataset.hpp"
#include "mlo/io/scan_files.hpp"

namespace mlo {

/// Poses in KITTI's rows: twelve numbers, the upper three rows of a 4x4 matrix; row i belongs to frame i.
/// @throws InputError naming file and line if a row is something else
PoseList read_kitti_poses(const std::filesystem::path& file);

/// Poses of the IMU (x ahead, y left, z up) from lines in KITTI's oxts format (latitude, longitude [deg],
/// altitude [m], roll, pitch, yaw [rad], ...), in the Mercator projection at the first one's latitude, about
/// the first one's place; line i belongs to frame i.
/// @throws InputError naming file and line if a line is something else
PoseList read_oxts_lines(const std::filesystem::path& file);

/// The same from KITTI raw's oxts folder (data/NNNNNNNNNN.txt); frames are the numbers of the files, stamps
/// those of timestamps.txt, if it is there.
PoseList read_oxts_folder(const std::filesystem::path& folder);

/// Poses of another body fixed to the first, in that body's frame at the first pose: both the world and the
/// body are changed by T_body_other.
/// @return as many poses; the first is the identity
PoseList rebased(PoseList poses, const SE3& T_body_other);

/// The poses at the scans, with their frames and stamps: interpolated on the manifold at the stamps where the
/// poses have stamps too, by frame otherwise. Scans without a pose (none of their frame, or more than a sweep
/// before the first or after the last) are left out.
PoseList poses_at(const std::vector<ScanFile>& scans, const PoseList& poses);

/// Ground truth of a sequence: lidar poses at the scans in the lidar frame at the first of them.
/// @param T_body_lidar  of the body whose poses are given (camera, IMU); without it there is no truth
/// @param origin        what the poses came from, for the warnings
/// @param warnings      gets a sentence if the truth does not cover all scans or cannot be used
std::optional<PoseList> lidar_truth(const std::vector<ScanFile>& scans, const PoseList& poses,
                                    const std::optional<SE3>& T_body_lidar, const std::string& origin,
                                    std::vector<std::string>& warnings);

}  // namespace mlo
