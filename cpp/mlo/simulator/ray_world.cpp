#include "mlo/simulator/ray_world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <embree3/rtcore.h>

namespace mlo::simulator {
namespace {

/// Poses within a sweep between which Embree interpolates linearly: 25 ms at 10 Hz, an error well below 1 mm.
constexpr unsigned kTimeSteps = 5;

std::array<float, 12> column_major_3x4(const SE3& pose) {
  const Eigen::Matrix4f matrix = pose.matrix().cast<float>();
  std::array<float, 12> values{};
  Eigen::Map<Eigen::Matrix<float, 3, 4>>(values.data()) = matrix.topRows<3>();
  return values;
}

void set_pose(RTCGeometry geometry, unsigned step, const SE3& pose) {
  const std::array<float, 12> values = column_major_3x4(pose);
  rtcSetGeometryTransform(geometry, step, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, values.data());
}

/// What rays need to know about an instance besides its triangles.
struct Instance {
  RTCGeometry geometry = nullptr;
  const Mesh* mesh = nullptr;
  int object_id = 0;
  Eigen::Matrix3d rotation =
      Eigen::Matrix3d::Identity();  ///< for the incidence: that at the middle of the sweep
};

RTCRayHit query_for(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double fraction,
                    double max_range_m) {
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(origin.x());
  query.ray.org_y = static_cast<float>(origin.y());
  query.ray.org_z = static_cast<float>(origin.z());
  query.ray.dir_x = static_cast<float>(direction.x());
  query.ray.dir_y = static_cast<float>(direction.y());
  query.ray.dir_z = static_cast<float>(direction.z());
  query.ray.time = static_cast<float>(fraction);
  query.ray.tfar = static_cast<float>(max_range_m);
  query.ray.mask = ~0U;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

/// Sets the ray's length to the nearest hit and returns the instance; nullptr if there is no hit within its
/// length.
const Instance* nearest(RTCScene scene, const std::vector<Instance>& instances, RTCRayHit& query) {
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
  return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? nullptr : &instances[query.hit.instID[0]];
}

RayHit described(const Instance& instance, const RTCRayHit& query, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d normal_mesh(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  const Eigen::Vector3d normal = (instance.rotation * normal_mesh).normalized();
  return RayHit{.range_m = query.ray.tfar,
                .cos_incidence = std::min(1.0, std::abs(normal.dot(direction))),
                .surface = instance.mesh->triangles[query.hit.primID].surface,
                .object_id = instance.object_id};
}

}  // namespace

// What rests is built once, what moves anew for each sweep: a ray is cast at both.
class RayWorld::Impl {
 public:
  explicit Impl(const Scene& scene) : scene_(scene), device_(rtcNewDevice(nullptr)), resting_(new_scene()) {
    for (const Mesh& mesh : scene.meshes) mesh_scenes_.push_back(add_mesh(mesh));
    for (const StaticPart& part : scene.statics) {
      if (scene.meshes[part.mesh].triangles.empty()) continue;
      add_resting(mesh_scenes_[part.mesh], scene.meshes[part.mesh], 0, part.T_world_mesh);
    }
    std::vector<std::size_t> first_part;  // by model, in part_scenes_
    for (const ObjectModel& model : scene.models) {
      first_part.push_back(part_scenes_.size());
      for (const ModelPart& part : model.parts) part_scenes_.push_back(add_mesh(part.mesh));
    }
    for (const SceneObject& object : scene.objects) {
      const ObjectModel& model = scene.models[object.model];
      const bool moves = object.motion.ever_moves();
      if (moves) movers_.push_back({&object, moving_instances_.size()});
      for (std::size_t i = 0; i < model.parts.size(); ++i) {
        RTCScene mesh_scene = part_scenes_[first_part[object.model] + i];
        if (moves) {
          moving_instances_.push_back(new_instance(mesh_scene, model.parts[i].mesh, object.id));
        } else {
          add_resting(mesh_scene, model.parts[i].mesh, object.id,
                      T_world_ground(scene, object, 0.0) * model.parts[i].T_ground_part(0.0));
        }
      }
    }
    rtcCommitScene(resting_);
  }

  ~Impl() {
    for (const Instance& instance : resting_instances_) rtcReleaseGeometry(instance.geometry);
    for (const Instance& instance : moving_instances_) rtcReleaseGeometry(instance.geometry);
    for (RTCScene mesh : mesh_scenes_) rtcReleaseScene(mesh);
    for (RTCScene mesh : part_scenes_) rtcReleaseScene(mesh);
    rtcReleaseScene(resting_);
    if (moving_ != nullptr) rtcReleaseScene(moving_);
    rtcReleaseDevice(device_);
  }

  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void set_sweep(double start_s, double end_s, const Eigen::Vector3d& place_world, double reach_m) {
    if (moving_ != nullptr) rtcReleaseScene(moving_);
    moving_ = new_scene();
    const double middle_s = 0.5 * (start_s + end_s);
    for (const Mover& mover : movers_) {
      const SceneObject& object = *mover.object;
      const ObjectModel& model = scene_.models[object.model];
      const SE3 T_world_middle = T_world_ground(scene_, object, middle_s);
      if ((T_world_middle.translation() - place_world).norm() > reach_m + model.size_lwh_m.norm()) continue;
      for (std::size_t i = 0; i < model.parts.size(); ++i) {
        Instance& instance = moving_instances_[mover.first_instance + i];
        set_poses(instance.geometry, object, model.parts[i], start_s, end_s);
        instance.rotation = T_world_middle.rotation().toRotationMatrix();
        rtcAttachGeometryByID(moving_, instance.geometry, static_cast<unsigned>(mover.first_instance + i));
      }
    }
    rtcCommitScene(moving_);
  }

  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double fraction,
                             double max_range_m) const {
    RTCRayHit query = query_for(origin, direction, fraction, max_range_m);
    const Instance* resting = nearest(resting_, resting_instances_, query);
    std::optional<RayHit> hit;
    if (resting != nullptr) hit = described(*resting, query, direction);
    if (moving_ == nullptr) return hit;
    const Instance* moving = nearest(moving_, moving_instances_, query);
    if (moving != nullptr) hit = described(*moving, query, direction);
    return hit;
  }

 private:
  struct Mover {
    const SceneObject* object;
    std::size_t first_instance;
  };

  RTCScene new_scene() const {
    RTCScene scene = rtcNewScene(device_);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    return scene;
  }

  RTCScene add_mesh(const Mesh& mesh) const {
    RTCScene scene = new_scene();
    if (!mesh.triangles.empty()) {
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
      for (const Eigen::Vector3f& vertex : mesh.vertices) vertices = std::copy_n(vertex.data(), 3, vertices);
      auto* corners = static_cast<std::uint32_t*>(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                  3 * sizeof(std::uint32_t), mesh.triangles.size()));
      for (const Triangle& triangle : mesh.triangles)
        corners = std::ranges::copy(triangle.corners, corners).out;
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
    return scene;
  }

  Instance new_instance(RTCScene mesh_scene, const Mesh& mesh, int object_id) const {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, mesh_scene);
    return {.geometry = geometry, .mesh = &mesh, .object_id = object_id};
  }

  void add_resting(RTCScene mesh_scene, const Mesh& mesh, int object_id, const SE3& T_world_mesh) {
    Instance instance = new_instance(mesh_scene, mesh, object_id);
    instance.rotation = T_world_mesh.rotation().toRotationMatrix();
    set_pose(instance.geometry, 0, T_world_mesh);
    rtcCommitGeometry(instance.geometry);
    rtcAttachGeometryByID(resting_, instance.geometry, static_cast<unsigned>(resting_instances_.size()));
    resting_instances_.push_back(instance);
  }

  void set_poses(RTCGeometry geometry, const SceneObject& object, const ModelPart& part, double start_s,
                 double end_s) const {
    rtcSetGeometryTimeStepCount(geometry, kTimeSteps);
    for (unsigned step = 0; step < kTimeSteps; ++step) {
      const double time_s = start_s + (end_s - start_s) * step / (kTimeSteps - 1);
      const SE3 T_world_part =
          T_world_ground(scene_, object, time_s) * part.T_ground_part(object.motion.at(time_s).travelled_m);
      set_pose(geometry, step, T_world_part);
    }
    rtcCommitGeometry(geometry);
  }

  const Scene& scene_;
  RTCDevice device_;
  RTCScene resting_;
  RTCScene moving_ = nullptr;
  std::vector<RTCScene> mesh_scenes_, part_scenes_;
  std::vector<Instance> resting_instances_, moving_instances_;
  std::vector<Mover> movers_;
};

RayWorld::RayWorld(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
RayWorld::~RayWorld() = default;

void RayWorld::set_sweep(double start_s, double end_s, const Eigen::Vector3d& place_world, double reach_m) {
  impl_->set_sweep(start_s, end_s, place_world, reach_m);
}

std::optional<RayHit> RayWorld::cast(const Eigen::Vector3d& origin_world,
                                     const Eigen::Vector3d& direction_world, double sweep_fraction,
                                     double max_range_m) const {
  return impl_->cast(origin_world, direction_world, sweep_fraction, max_range_m);
}

}  // namespace mlo::simulator
