#include "mlo/io/velodyne_bin.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

using Record = std::array<float, 4>;
static_assert(std::endian::native == std::endian::little, "the records are read as they are in memory");

}  // namespace

PointCloudFile read_velodyne_bin(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  if (bytes.size() % sizeof(Record) != 0) {
    throw InputError(
        fmt::format("{}: {} bytes are not a whole number of 16-byte points (x, y, z, intensity as "
                    "floats): truncated or another format; fetch it again or leave it out",
                    file.string(), bytes.size()));
  }
  const std::size_t count = bytes.size() / sizeof(Record);
  PointCloudFile result;
  result.has_intensity = true;
  result.points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    Record record;
    std::memcpy(record.data(), bytes.data() + i * sizeof(Record), sizeof(Record));
    Point point;
    point.p_lidar = {record[0], record[1], record[2]};
    point.intensity = record[3];
    if (point.p_lidar.allFinite()) result.points.push_back(point);
  }
  result.invalid_points = count - result.points.size();
  return result;
}

}  // namespace mlo
