#pragma once

#include <filesystem>
#include <vector>

#include "mlo/io/dataset.hpp"
#include "mlo/io/sequence_files.hpp"

namespace mlo {

/// Drives of KITTI raw (synchronised and rectified) in a folder: one drive, the folder of a date, or the
/// folder above.
std::vector<SequenceFolder> find_kitti_raw(const std::filesystem::path& folder);

/// Scans are as measured: a sweep begins behind the car, runs clockwise, and passes straight ahead at its
/// stamp (timestamps.txt); durations come from timestamps_start.txt and timestamps_end.txt.
/// @throws InputError if a file that is there cannot be understood
Dataset open_kitti_raw(const SequenceFolder& drive, const OpenOptions& options);

}  // namespace mlo
