#pragma once

#include <filesystem>

#include "mlo/io/point_cloud_file.hpp"

namespace mlo {

/// Reads records of four little-endian floats (x, y, z [m], intensity), as KITTI stores its scans: no rings,
/// no times. A file without a single valid point gives an empty list.
/// @throws InputError if the file is missing, unreadable or not a whole number of records
PointCloudFile read_velodyne_bin(const std::filesystem::path& file);

}  // namespace mlo
