#include "mlo/mapping/static_map.hpp"

namespace mlo {

StaticMap::StaticMap(const StaticMapConfig& config)
    : inverse_voxel_(static_cast<float>(1.0 / config.voxel_m)) {}

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
    if (occupied_.insert(voxel_key(p_map, inverse_voxel_)).second) {
      points_.push_back({p_map, feature.intensity, label});
    }
  }
}

}  // namespace mlo
