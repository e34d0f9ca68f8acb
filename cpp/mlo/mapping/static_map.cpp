#include "mlo/mapping/static_map.hpp"

namespace mlo {

StaticMap::StaticMap(const StaticMapConfig& config)
    : inverse_voxel_(static_cast<float>(1.0 / config.voxel_m)), shards_(kNumShards) {}

void StaticMap::insert(const Percept& percept, const SweepMotion& motion, const SE3& T_map_lidar) {
  insert(percept.edge.candidates, MapLabel::edge, motion, T_map_lidar);
  insert(percept.ground.candidates, MapLabel::ground, motion, T_map_lidar);
  insert(percept.surface.candidates, MapLabel::surface, motion, T_map_lidar);
}

void StaticMap::insert(std::span<const FeaturePoint> features, MapLabel label, const SweepMotion& motion,
                       const SE3& T_map_lidar) {
  for (const FeaturePoint& feature : features) {
    const Eigen::Vector3d p_lidar =
        motion.undistort(feature.p_lidar.cast<double>(), static_cast<double>(feature.sweep_fraction));
    const Eigen::Vector3f p_map = (T_map_lidar * p_lidar).cast<float>();
    const VoxelKey key = voxel_key(p_map, inverse_voxel_);
    // The upper bits: the tables use the lower ones.
    Shard& shard = shards_[(VoxelKeyHash{}(key) >> 40U) % kNumShards];
    if (shard.occupied.insert(key).second) shard.points.push_back({p_map, feature.intensity, label});
  }
}

std::size_t StaticMap::size() const {
  std::size_t size = 0;
  for (const Shard& shard : shards_) size += shard.points.size();
  return size;
}

std::vector<MapPoint> StaticMap::points() const {
  std::vector<MapPoint> all;
  all.reserve(size());
  for (const Shard& shard : shards_) all.insert(all.end(), shard.points.begin(), shard.points.end());
  return all;
}

}  // namespace mlo
