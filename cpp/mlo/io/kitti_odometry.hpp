#pragma once

#include <filesystem>
#include <vector>

#include "mlo/io/dataset.hpp"
#include "mlo/io/sequence_files.hpp"

namespace mlo {

/// Sequences of the KITTI odometry benchmark in a folder: its root, its `sequences` folder, or one sequence
/// (velodyne/NNNNNN.bin with calib.txt and times.txt), or the velodyne folder in it.
std::vector<SequenceFolder> find_kitti_odometry(const std::filesystem::path& folder);

/// Scans are motion-compensated to the stamps of times.txt, the middle of the sweep; elevations carry the
/// known bias of 0.205 degrees (sensor.vertical_correction_deg), which is not yet corrected in what is read.
/// @throws InputError if a file that is there cannot be understood
Dataset open_kitti_odometry(const SequenceFolder& sequence, const OpenOptions& options);

}  // namespace mlo
