#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "mlo/core/types.hpp"

namespace mlo {

/// The points of a PCD or PLY file, as the file has them.
struct PointCloudFile {
  /// In the order of the file. `ring` is the file's own number (some count from the lowest beam); kNoRing
  /// where it has none. `intensity` is not rescaled. `sweep_fraction` is not set: times are given beside.
  std::vector<Point> points;
  /// Time of each point [s], from the file's own zero; empty without a time field. The unit is that of
  /// s, ms, us and ns (of us and ns for whole numbers) in which all times together span 2 ms to 2 s, as a
  /// sweep does. Where none fits: whole numbers are ns; of floats, what lies beyond 1e17 is ns, 1e14 us, 1e11
  /// ms, else s.
  std::vector<double> times_s;
  double time_unit_s = 0.0;  ///< how the time field was understood: 1, 1e-3, 1e-6 or 1e-9; 0 without one
  bool has_time = false;
  bool has_ring = false;
  bool has_intensity = false;
  std::size_t invalid_points = 0;  ///< left out: NaN or infinite coordinates or time
};

/// Reads a .pcd (ascii, binary, binary_compressed) or .ply (ascii, binary of either byte order) file. Fields
/// are found by name, in any order and of any type; unknown ones are read over:
///   x y z · intensity, i, reflectivity, reflectance, remission · time, t, timestamp, time_stamp,
///   time_offset, offset_time · ring, channel, line. The sensor pose of PCD (VIEWPOINT) is not applied.
/// @throws InputError with file, line or byte, and remedy
PointCloudFile read_point_cloud(const std::filesystem::path& path);

/// The same for a map: intensity 0 and label unknown where the file does not have them.
std::vector<MapPoint> read_map(const std::filesystem::path& path);

/// Writes x y z intensity (float32) and label (uint8, the numbers of MapLabel) as binary little-endian PLY.
/// The file appears whole or not at all. @throws InputError when it can not be written
void write_ply(const std::filesystem::path& path, std::span<const MapPoint> points);

enum class PcdEncoding { binary, binary_compressed };

/// The same as PCD 0.7. binary_compressed is smaller, but needs memory for all points at once.
void write_pcd(const std::filesystem::path& path, std::span<const MapPoint> points,
               PcdEncoding encoding = PcdEncoding::binary);

}  // namespace mlo
