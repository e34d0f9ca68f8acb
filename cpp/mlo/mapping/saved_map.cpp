#include "mlo/mapping/saved_map.hpp"

#include "mlo/core/voxel_grid.hpp"

namespace mlo {
namespace {

constexpr float kTile_m = 20.0F;

}  // namespace

SavedMap::SavedMap(std::span<const MapPoint> points) : empty_(points.empty()) {
  for (const MapPoint& point : points) {
    const VoxelKey key = voxel_key(point.p_map, 1.0F / kTile_m);
    tiles_[{key.x, key.y}].push_back(point);
  }
}

std::vector<MapPoint> SavedMap::take_near(const Eigen::Vector3f& center_map, float radius_m) {
  std::vector<MapPoint> taken;
  for (auto it = tiles_.begin(); it != tiles_.end();) {
    const Eigen::Vector2f middle(static_cast<float>(it->first.first) + 0.5F,
                                 static_cast<float>(it->first.second) + 0.5F);
    if ((middle * kTile_m - center_map.head<2>()).norm() > radius_m) {
      ++it;
      continue;
    }
    taken.insert(taken.end(), it->second.begin(), it->second.end());
    taken_.push_back(it->first);
    it = tiles_.erase(it);
  }
  return taken;
}

}  // namespace mlo
