#include "mlo/scene/cloud_codec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mlo/core/archive.hpp"

namespace mlo {
namespace {

/// The bytes of a cloud, field by field.
struct PackedCloud {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double step_m = 0.0;
  float intensity_step = 0.0F;
  std::vector<PointGroup> groups;
  // Differences to the point before, modulo 2^16: the low bytes of all points, then their high bytes.
  std::array<std::string, 3> coordinates;
  std::string intensities;

  static void archive(auto& self, auto& bytes) {
    bytes(self.origin, self.step_m, self.intensity_step, self.groups, self.coordinates, self.intensities);
  }
};

double fitting_step(const SceneCloud& cloud, const Eigen::Vector3d& origin, double step_m) {
  double farthest_m = 0.0;
  for (const ScenePoint& point : cloud.points) {
    farthest_m = std::max(farthest_m, (point.p.cast<double>() - origin).cwiseAbs().maxCoeff());
  }
  while (farthest_m / step_m > std::numeric_limits<std::int16_t>::max()) step_m *= 2.0;
  return step_m;
}

std::string pack_axis(const SceneCloud& cloud, int axis, double origin_m, double step_m) {
  const std::size_t count = cloud.points.size();
  std::string bytes(2 * count, '\0');
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double steps = std::round((static_cast<double>(cloud.points[i].p[axis]) - origin_m) / step_m);
    const auto value = static_cast<std::uint16_t>(static_cast<std::int16_t>(steps));
    const auto difference = static_cast<std::uint16_t>(value - before);
    bytes[i] = static_cast<char>(difference & 0xFFU);
    bytes[count + i] = static_cast<char>(difference >> 8U);
    before = value;
  }
  return bytes;
}

void unpack_axis(const std::string& bytes, int axis, double origin_m, double step_m, SceneCloud& cloud) {
  const std::size_t count = cloud.points.size();
  std::uint16_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned low = static_cast<std::uint8_t>(bytes[i]);
    const unsigned high = static_cast<std::uint8_t>(bytes[count + i]);
    value = static_cast<std::uint16_t>(value + (high << 8U | low));
    cloud.points[i].p[axis] = static_cast<float>(origin_m + step_m * static_cast<std::int16_t>(value));
  }
}

}  // namespace

void SceneCloud::add(const ScenePoint& point, MapLabel label, long object) {
  const bool joins = !groups.empty() && groups.back().label == label && groups.back().object == object;
  if (!joins) groups.push_back({label, object, 0});
  ++groups.back().count;
  points.push_back(point);
}

std::string encode_cloud(const SceneCloud& cloud, const Eigen::Vector3d& origin, double step_m) {
  PackedCloud packed;
  packed.origin = origin;
  packed.step_m = fitting_step(cloud, origin, step_m);
  packed.groups = cloud.groups;
  for (int axis = 0; axis < 3; ++axis) {
    packed.coordinates[static_cast<std::size_t>(axis)] = pack_axis(cloud, axis, origin[axis], packed.step_m);
  }
  float largest = 1.0F;
  for (const ScenePoint& point : cloud.points) largest = std::max(largest, point.intensity);
  packed.intensity_step = largest / 255.0F;
  for (const ScenePoint& point : cloud.points) {
    const float steps = std::round(std::max(0.0F, point.intensity) / packed.intensity_step);
    packed.intensities += static_cast<char>(static_cast<std::uint8_t>(steps));
  }
  ArchiveWriter writer;
  writer(packed);
  return writer.take();
}

SceneCloud decode_cloud(std::string_view bytes, const std::string& source) {
  PackedCloud packed;
  ArchiveReader reader(bytes, source);
  reader(packed);
  const std::size_t count = packed.intensities.size();
  std::uint64_t grouped = 0;
  for (const PointGroup& group : packed.groups) grouped += group.count;
  const auto fits = [&](const std::string& axis) { return axis.size() == 2 * count; };
  if (grouped != count || !std::all_of(packed.coordinates.begin(), packed.coordinates.end(), fits)) {
    throw InputError(source + ": the data is damaged: the parts of a cloud differ in length");
  }
  SceneCloud cloud;
  cloud.groups = std::move(packed.groups);
  cloud.points.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    cloud.points[i].intensity = packed.intensity_step * static_cast<std::uint8_t>(packed.intensities[i]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    unpack_axis(packed.coordinates[static_cast<std::size_t>(axis)], axis, packed.origin[axis], packed.step_m,
                cloud);
  }
  return cloud;
}

}  // namespace mlo
