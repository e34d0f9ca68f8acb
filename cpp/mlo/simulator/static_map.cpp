#include "mlo/simulator/static_map.hpp"

#include <cmath>

namespace mlo::simulator {
namespace {

MapLabel map_label(Surface surface) {
  switch (surface) {
    case Surface::road:
    case Surface::sidewalk:
    case Surface::grass:
      return MapLabel::ground;
    case Surface::pole:
    case Surface::bark:
      return MapLabel::edge;
    case Surface::leaf:
      return MapLabel::unknown;
    default:
      return MapLabel::surface;
  }
}

/// 21 bits per axis: unique within 200 km at 0.1 m.
std::uint64_t voxel_key(const Eigen::Vector3f& p, double voxel_m) {
  constexpr std::int64_t kOffset = 1 << 20;
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<std::int64_t>(std::floor(p[axis] / voxel_m)) + kOffset;
    key = key << 21 | (static_cast<std::uint64_t>(cell) & 0x1FFFFF);
  }
  return key;
}

}  // namespace

void StaticMap::add(const Sweep& sweep, const SE3& T_map_world) {
  for (const SimulatedPoint& point : sweep.points) {
    if (point.object_id != 0 || !taken_.insert(voxel_key(point.p_world, voxel_m_)).second) continue;
    MapPoint entry;
    entry.p_map = (T_map_world * point.p_world.cast<double>()).cast<float>();
    entry.intensity = point.measured.intensity;
    entry.label = map_label(point.surface);
    points_.push_back(entry);
  }
}

}  // namespace mlo::simulator
