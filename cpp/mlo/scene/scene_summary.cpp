#include "mlo/scene/scene_summary.hpp"

namespace mlo {

SceneSummary summarize(const SceneFile& scene) {
  struct Identity {
    ObjectClass object_class = ObjectClass::car;
    int moved = 0;  // scans in which it moved, less those in which it stood
  };
  SceneSummary summary;
  std::map<long, Identity> identities;
  Eigen::Vector3d last_position = Eigen::Vector3d::Zero();
  summary.scans = scene.num_scans();
  for (std::size_t i = 0; i < summary.scans; ++i) {
    const SceneScan scan = scene.scan(i);
    ++summary.by_status.at(static_cast<std::size_t>(scan.status));
    const Eigen::Vector3d& position = scan.T_map_lidar.translation();
    if (i > 0) summary.path_m += (position - last_position).norm();
    last_position = position;
    for (const SceneObject& object : scan.objects) {
      Identity& identity = identities[object.id];
      identity.object_class = object.object_class;
      identity.moved += object.moving ? 1 : -1;
    }
  }
  if (summary.scans > 0) {
    summary.first_stamp_s = scene.stamp_s(0);
    summary.last_stamp_s = scene.stamp_s(summary.scans - 1);
  }
  for (const auto& [id, identity] : identities) {
    ++summary.objects[std::string(to_string(identity.object_class))];
    if (identity.moved > 0) ++summary.objects_moving;
  }
  summary.map_points = scene.map().size();
  return summary;
}

}  // namespace mlo
