#include "mlo/simulator/ground_truth.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "mlo/io/kitti_box.hpp"
#include "mlo/simulator/surfaces.hpp"

namespace mlo::simulator {
namespace {

/// Share of some triangles facing the lidar that it sees at the stamp.
double visible_share(const Scene& scene, const SceneObject& object, const RayWorld& world, const Sweep& sweep,
                     const Eigen::Vector3d& lidar_world) {
  constexpr std::size_t kProbes = 48;
  constexpr double kTolerance_m = 0.05;
  const double fraction = (sweep.stamp_s - sweep.start_s) / (sweep.end_s - sweep.start_s);
  const SE3 T_world_body = T_world_ground(scene, object, sweep.stamp_s);
  const double travelled = object.motion.at(sweep.stamp_s).travelled_m;
  int facing = 0;
  int seen = 0;
  for (const ModelPart& part : scene.models[object.model].parts) {
    const SE3 T_world_part = T_world_body * part.T_ground_part(travelled);
    const std::size_t stride = 1 + part.mesh.triangles.size() / kProbes;
    for (std::size_t i = 0; i < part.mesh.triangles.size(); i += stride) {
      const auto& [a, b, c] = part.mesh.triangles[i].corners;
      const Eigen::Vector3f middle =
          (part.mesh.vertices[a] + part.mesh.vertices[b] + part.mesh.vertices[c]) / 3.0F;
      const Eigen::Vector3d ray = T_world_part * middle.cast<double>() - lidar_world;
      const auto hit = world.cast(lidar_world, ray.normalized(), fraction, ray.norm() + kTolerance_m);
      if (!hit) continue;
      const bool own = hit->object_id == object.id;
      // hidden by the object itself: a side that does not face the lidar
      if (own && hit->range_m < ray.norm() - kTolerance_m) continue;
      ++facing;
      if (own) ++seen;
    }
  }
  return facing == 0 ? 0.0 : static_cast<double>(seen) / facing;
}

std::string label_type(ObjectClass object_class) {
  if (object_class == ObjectClass::other) return "Tram";
  std::string name(to_string(object_class));
  name[0] = static_cast<char>(name[0] - 'a' + 'A');
  return name;
}

int occlusion_level(double visible_share) {
  return visible_share > 0.75 ? 0 : visible_share > 0.35 ? 1 : 2;
}
int truncation_level(double truncation) {
  return truncation < 0.05 ? 0 : truncation < 0.5 ? 1 : 2;
}

}  // namespace

std::vector<ObjectTruth> objects_at(const Scene& scene, const RayWorld& world, const Sweep& sweep,
                                    double reach_m) {
  std::unordered_map<int, std::size_t> points;
  for (const SimulatedPoint& point : sweep.points) {
    if (point.object_id > 0) ++points[point.object_id];
  }
  const SE3 T_world_lidar = scene.robot.T_world_lidar(scene.terrain, sweep.stamp_s);
  std::vector<ObjectTruth> objects;
  for (const SceneObject& object : scene.objects) {
    const SE3 T_world_body = T_world_object(scene, object, sweep.stamp_s);
    if ((T_world_body.translation() - T_world_lidar.translation()).norm() > reach_m) continue;
    constexpr double kStep_s = 0.01;
    const PlanarState state = object.motion.at(sweep.stamp_s);
    const ObjectModel& model = scene.models[object.model];
    ObjectTruth truth;
    truth.id = object.id;
    truth.object_class = model.object_class;
    truth.T_world_object = T_world_body;
    truth.velocity_world_mps = (T_world_object(scene, object, sweep.stamp_s + kStep_s).translation() -
                                T_world_object(scene, object, sweep.stamp_s - kStep_s).translation()) /
                               (2.0 * kStep_s);
    truth.yaw_rate_radps = state.yaw_rate_radps;
    truth.moving = std::abs(state.speed_mps) > ObjectTruth::kRest_mps;
    truth.detectable = object.detectable;
    truth.box_lidar = upright_box(T_world_lidar.inverse() * T_world_body, model.size_lwh_m);
    truth.points = points[object.id];
    if (truth.points > 0)
      truth.visible_share = visible_share(scene, object, world, sweep, T_world_lidar.translation());
    objects.push_back(truth);
  }
  return objects;
}

std::uint32_t point_label(const SimulatedPoint& point, const std::vector<ObjectTruth>& objects) {
  if (point.object_id == 0) return semantic_label(point.surface);
  const auto truth = std::ranges::lower_bound(objects, point.object_id, {}, &ObjectTruth::id);
  if (truth == objects.end() || truth->id != point.object_id) return semantic_label(point.surface);
  return static_cast<std::uint32_t>(point.object_id) << 16 |
         semantic_label(truth->object_class, truth->moving);
}

std::string label_lines(const Rig& rig, std::size_t frame, const std::vector<ObjectTruth>& objects) {
  std::string lines;
  for (const ObjectTruth& object : objects) {
    const std::optional<ImageView> view = project(rig, object.box_lidar);
    if (object.points < kMinLabelPoints || !view) continue;
    const KittiBox box = box_in_camera(object.box_lidar, rig.T_camera_lidar);
    const Eigen::Vector3d& size = object.box_lidar.size_lwh_m;
    lines += fmt::format(
        "{} {} {} {} {} {:.6f} {:.2f} {:.2f} {:.2f} {:.2f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} "
        "{:.6f}\n",
        frame, object.id, label_type(object.object_class), truncation_level(view->truncation),
        occlusion_level(object.visible_share), observation_angle_rad(box), view->box.left_px,
        view->box.top_px, view->box.right_px, view->box.bottom_px, size.z(), size.y(), size.x(),
        box.bottom_camera0_m.x(), box.bottom_camera0_m.y(), box.bottom_camera0_m.z(), box.rotation_y_rad);
  }
  return lines;
}

std::string object_csv_header() {
  return "frame,id,class,state,x_m,y_m,z_m,qx,qy,qz,qw,length_m,width_m,height_m,vx_mps,vy_mps,vz_mps,yaw_"
         "rate_radps,"
         "lidar_x_m,lidar_y_m,lidar_z_m,lidar_yaw_rad,points,visible_share,detectable\n";
}

std::string object_csv_lines(const SE3& T_map_world, std::size_t frame,
                             const std::vector<ObjectTruth>& objects) {
  std::string lines;
  for (const ObjectTruth& object : objects) {
    const SE3 pose = T_map_world * object.T_world_object;
    const Eigen::Vector3d& p = pose.translation();
    const Eigen::Quaterniond& q = pose.rotation();
    const Eigen::Vector3d& size = object.box_lidar.size_lwh_m;
    const Eigen::Vector3d v = T_map_world.rotation() * object.velocity_world_mps;
    const Eigen::Vector3d& c = object.box_lidar.center_lidar_m;
    lines +=
        fmt::format("{},{},{},{},{:.5f},{:.5f},{:.5f},{:.8f},{:.8f},{:.8f},{:.8f},{:.4f},{:.4f},{:.4f},",
                    frame, object.id, to_string(object.object_class), object.moving ? "moving" : "at_rest",
                    p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), size.x(), size.y(), size.z());
    lines += fmt::format("{:.4f},{:.4f},{:.4f},{:.5f},{:.5f},{:.5f},{:.5f},{:.6f},{},{:.3f},{}\n", v.x(),
                         v.y(), v.z(), object.yaw_rate_radps, c.x(), c.y(), c.z(), object.box_lidar.yaw_rad,
                         object.points, object.visible_share, object.detectable ? 1 : 0);
  }
  return lines;
}

}  // namespace mlo::simulator
