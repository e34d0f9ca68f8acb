#include "mlo/io/velodyne_bin.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

using Record = std::array<float, 4>;
static_assert(std::endian::native == std::endian::little, "the records are read as they are in memory");

std::vector<Record> read_records(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream || std::filesystem::is_directory(file)) {
    throw InputError(
        fmt::format("{}: cannot be opened; check that it exists and may be read", file.string()));
  }
  const auto size = static_cast<std::size_t>(stream.tellg());
  if (size % sizeof(Record) != 0) {
    throw InputError(
        fmt::format("{}: {} bytes are not a whole number of 16-byte points (x, y, z, intensity as "
                    "floats): truncated or another format; fetch it again or leave it out",
                    file.string(), size));
  }
  std::vector<Record> records(size / sizeof(Record));
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(records.data()), static_cast<std::streamsize>(size));
  if (!stream) throw InputError(fmt::format("{}: reading failed; check the disk", file.string()));
  return records;
}

}  // namespace

BinPoints read_velodyne_bin(const std::filesystem::path& file) {
  const std::vector<Record> records = read_records(file);
  BinPoints result;
  result.points.reserve(records.size());
  for (const auto& [x, y, z, intensity] : records) {
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) continue;
    Point point;
    point.p_lidar = {x, y, z};
    point.intensity = intensity;
    result.points.push_back(point);
  }
  result.invalid_points = records.size() - result.points.size();
  return result;
}

}  // namespace mlo
