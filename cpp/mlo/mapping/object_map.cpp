#include "mlo/mapping/object_map.hpp"

namespace mlo {

void ObjectMap::insert(std::span<const Eigen::Vector3f> points_map, const SE3& T_map_object, double voxel_m) {
  const SE3 T_object_map = T_map_object.inverse();
  const auto inverse_voxel = static_cast<float>(1.0 / voxel_m);
  for (const Eigen::Vector3f& p_map : points_map) {
    const Eigen::Vector3f p_object = (T_object_map * p_map.cast<double>()).cast<float>();
    if (taken_.insert(voxel_key(p_object, inverse_voxel)).second) points_.push_back(p_object);
  }
}

void ObjectMap::clear() {
  points_.clear();
  taken_.clear();
}

}  // namespace mlo
