#pragma once

#include <filesystem>
#include <vector>

#include "mlo/core/types.hpp"

namespace mlo {

/// The content of one .bin file.
struct BinPoints {
  std::vector<Point> points;       ///< in the order of the file; ring and sweep fraction are not in it
  std::size_t invalid_points = 0;  ///< left out: NaN or infinite coordinates
};

/// Reads records of four little-endian floats (x, y, z [m], intensity), as KITTI stores its scans.
/// A file without a single valid point gives an empty list.
/// @throws InputError if the file is missing, unreadable or not a whole number of records
BinPoints read_velodyne_bin(const std::filesystem::path& file);

}  // namespace mlo
