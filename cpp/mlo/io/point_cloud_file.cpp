#include "mlo/io/point_cloud_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/cloud_rows.hpp"
#include "mlo/io/lzf.hpp"
#include "mlo/io/scalar.hpp"

namespace mlo {
namespace {

float finite_or_zero(double value) {
  return std::isfinite(value) ? static_cast<float>(value) : 0.0F;
}

std::uint16_t ring_number(double value) {
  return value >= 0.0 && value < Point::kNoRing ? static_cast<std::uint16_t>(value) : Point::kNoRing;
}

MapLabel map_label(double value) {
  const bool known = value >= 0.0 && value <= static_cast<double>(MapLabel::object);
  return known ? static_cast<MapLabel>(static_cast<std::uint8_t>(value)) : MapLabel::unknown;
}

/// See PointCloudFile::times_s for the rule.
double find_time_unit_s(const std::vector<double>& times, bool integers) {
  constexpr double kShortestSweep_s = 2e-3;
  constexpr double kLongestSweep_s = 2.0;
  if (times.empty()) return integers ? 1e-9 : 1.0;
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  for (const double unit_s : {1.0, 1e-3, 1e-6, 1e-9}) {
    if (integers && unit_s > 1e-6) continue;
    const double span_s = (*last - *first) * unit_s;
    if (span_s >= kShortestSweep_s && span_s < kLongestSweep_s) return unit_s;
  }
  if (integers || *last > 1e17) return 1e-9;
  if (*last > 1e14) return 1e-6;
  return *last > 1e11 ? 1e-3 : 1.0;
}

void append_bytes(std::string& bytes, const MapPoint& point) {
  for (const float value : {point.p_map.x(), point.p_map.y(), point.p_map.z(), point.intensity}) {
    append_float32(bytes, value);
  }
  bytes += static_cast<char>(point.label);
}

void write_rows(AtomicFile& file, std::span<const MapPoint> points) {
  std::string row;
  for (const MapPoint& point : points) {
    row.clear();
    append_bytes(row, point);
    file.write(row);
  }
}

/// All x, then all y, and so on: the order of compressed PCD files.
std::string columns_of(std::span<const MapPoint> points) {
  std::string bytes;
  for (int axis = 0; axis < 3; ++axis) {
    for (const MapPoint& point : points) append_float32(bytes, point.p_map(axis));
  }
  for (const MapPoint& point : points) append_float32(bytes, point.intensity);
  for (const MapPoint& point : points) bytes += static_cast<char>(point.label);
  return bytes;
}

void write_compressed(AtomicFile& file, std::span<const MapPoint> points, const std::filesystem::path& path) {
  const std::string columns = columns_of(points);
  const std::string compressed = lzf_compress(columns);
  if (std::max(columns.size(), compressed.size()) > std::numeric_limits<std::uint32_t>::max()) {
    throw InputError(fmt::format("{}: {} points are too many for a compressed PCD file; write it as binary",
                                 path.string(), points.size()));
  }
  std::string sizes;
  append_uint32(sizes, static_cast<std::uint32_t>(compressed.size()));
  append_uint32(sizes, static_cast<std::uint32_t>(columns.size()));
  file.write(sizes);
  file.write(compressed);
}

}  // namespace

PointCloudFile read_point_cloud(const std::filesystem::path& path) {
  PointCloudFile cloud;
  bool integer_time = false;
  const auto begin = [&](const CloudFields& fields, std::size_t rows) {
    cloud.has_time = fields.has(Role::time);
    cloud.has_ring = fields.has(Role::ring);
    cloud.has_intensity = fields.has(Role::intensity);
    integer_time = fields.integer_time;
    cloud.points.reserve(rows);
    if (cloud.has_time) cloud.times_s.reserve(rows);
  };
  const auto add = [&cloud](const RoleValues& row) {
    Point point;
    point.p_lidar = position_of(row);
    const double time = row[index_of(Role::time)];
    if (!point.p_lidar.allFinite() || !std::isfinite(time)) {
      ++cloud.invalid_points;
      return;
    }
    point.intensity = finite_or_zero(row[index_of(Role::intensity)]);
    point.ring = ring_number(row[index_of(Role::ring)]);
    cloud.points.push_back(point);
    if (cloud.has_time) cloud.times_s.push_back(time);
  };
  read_cloud_rows(path, {begin, add});
  if (!cloud.has_time) return cloud;
  cloud.time_unit_s = find_time_unit_s(cloud.times_s, integer_time);
  for (double& time : cloud.times_s) time *= cloud.time_unit_s;
  return cloud;
}

std::vector<MapPoint> read_map(const std::filesystem::path& path) {
  std::vector<MapPoint> points;
  const auto begin = [&points](const CloudFields&, std::size_t rows) { points.reserve(rows); };
  const auto add = [&points](const RoleValues& row) {
    const MapPoint point{position_of(row), finite_or_zero(row[index_of(Role::intensity)]),
                         map_label(row[index_of(Role::label)])};
    if (point.p_map.allFinite()) points.push_back(point);
  };
  read_cloud_rows(path, {begin, add});
  return points;
}

void write_ply(const std::filesystem::path& path, std::span<const MapPoint> points) {
  AtomicFile file(path);
  file.write(
      fmt::format("ply\n"
                  "format binary_little_endian 1.0\n"
                  "comment label: 0 unknown, 1 ground, 2 edge, 3 surface, 4 object\n"
                  "element vertex {}\n"
                  "property float x\n"
                  "property float y\n"
                  "property float z\n"
                  "property float intensity\n"
                  "property uchar label\n"
                  "end_header\n",
                  points.size()));
  write_rows(file, points);
  file.commit();
}

void write_pcd(const std::filesystem::path& path, std::span<const MapPoint> points, PcdEncoding encoding) {
  const bool compressed = encoding == PcdEncoding::binary_compressed;
  AtomicFile file(path);
  file.write(
      fmt::format("# .PCD v0.7 - Point Cloud Data file format\n"
                  "# label: 0 unknown, 1 ground, 2 edge, 3 surface, 4 object\n"
                  "VERSION 0.7\n"
                  "FIELDS x y z intensity label\n"
                  "SIZE 4 4 4 4 1\n"
                  "TYPE F F F F U\n"
                  "COUNT 1 1 1 1 1\n"
                  "WIDTH {0}\n"
                  "HEIGHT 1\n"
                  "VIEWPOINT 0 0 0 1 0 0 0\n"
                  "POINTS {0}\n"
                  "DATA {1}\n",
                  points.size(), compressed ? "binary_compressed" : "binary"));
  if (compressed) {
    write_compressed(file, points, path);
  } else {
    write_rows(file, points);
  }
  file.commit();
}

}  // namespace mlo
