#include "mlo/pipeline/object_table.hpp"

#include <fmt/format.h>

#include "mlo/core/heading.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/io/trajectory_file.hpp"

namespace mlo {

std::string object_table_header() {
  return objects_csv_header() +
         ",track_state,yaw_rad,vx_mps,vy_mps,turn_rate_radps,"
         "moving_probability,sd_x_m,sd_y_m,sd_vx_mps,sd_vy_mps,sd_yaw_rad,sd_turn_rate_radps,x_lidar_m,y_"
         "lidar_m,"
         "z_lidar_m,yaw_lidar_rad,existence,hits,misses,motion_status";
}

std::string object_table_row(const ObjectRow& place, const TrackedObject& object) {
  const ObjectPose pose{.frame = place.frame,
                        .stamp_s = place.stamp_s,
                        .id = object.id,
                        .type = std::string(to_string(object.object_class)),
                        .state = object.moving ? "moving" : "at_rest",
                        .T_map_object = object.T_map_object,
                        .size_lwh_m = object.box.size_lwh_m,
                        .points = object.num_points};
  const Eigen::Vector4d sd = object.planar_covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::Vector2d yaw_sd = object.yaw_covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Box3d& box = object.box;
  return objects_csv_row(pose) +
         fmt::format(",{},{:.5f},{:.3f},{:.3f},{:.4f},{:.3f}", to_string(object.state),
                     yaw_of(object.T_map_object), object.velocity_map_mps.x(), object.velocity_map_mps.y(),
                     object.turn_rate_radps, object.moving_probability) +
         fmt::format(",{:.3f},{:.3f},{:.3f},{:.3f},{:.4f},{:.4f}", sd(0), sd(1), sd(2), sd(3), yaw_sd(0),
                     yaw_sd(1)) +
         fmt::format(",{:.4f},{:.4f},{:.4f},{:.5f},{:.2f},{},{},{}", box.center_lidar_m.x(),
                     box.center_lidar_m.y(), box.center_lidar_m.z(), box.yaw_rad, object.existence,
                     object.hits, object.misses, to_string(object.relative_motion.status));
}

void ObjectTrajectories::add(const ObjectRow& place, long id, const SE3& T_map_object) {
  PoseList& poses = by_id_[id];
  poses.frames.push_back(place.frame);
  poses.stamps_s.push_back(place.stamp_s);
  poses.T_world_body.push_back(T_map_object);
}

void ObjectTrajectories::write(const std::filesystem::path& folder) const {
  std::filesystem::create_directories(folder);
  for (const auto& [id, poses] : by_id_) write_tum_poses(folder / fmt::format("{:05}.txt", id), poses);
}

}  // namespace mlo
