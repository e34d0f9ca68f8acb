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

}  // namespace

class RayWorld::Impl {
 public:
  explicit Impl(const Scene& scene)
      : scene_(scene), device_(rtcNewDevice(nullptr)), top_(rtcNewScene(device_)) {
    rtcSetSceneFlags(top_, RTC_SCENE_FLAG_ROBUST);
    for (const Mesh& mesh : scene.meshes) static_scenes_.push_back(add_mesh(mesh));
    for (const ObjectModel& model : scene.models) {
      for (const ModelPart& part : model.parts) part_scenes_.push_back(add_mesh(part.mesh));
      first_part_.push_back(part_scenes_.size() - model.parts.size());
    }
    for (const StaticPart& part : scene.statics) {
      if (scene.meshes[part.mesh].triangles.empty()) continue;
      const RTCGeometry geometry = add_instance(static_scenes_[part.mesh], scene.meshes[part.mesh], 0);
      set_pose(geometry, 0, part.T_world_mesh);
      rotations_.back() = part.T_world_mesh.rotation().toRotationMatrix();
      rtcCommitGeometry(geometry);
    }
    for (const SceneObject& object : scene.objects) {
      const ObjectModel& model = scene.models[object.model];
      movers_.push_back({&object, geometries_.size()});
      for (std::size_t i = 0; i < model.parts.size(); ++i) {
        add_instance(part_scenes_[first_part_[object.model] + i], model.parts[i].mesh, object.id);
      }
    }
  }

  ~Impl() {
    for (RTCGeometry geometry : geometries_) rtcReleaseGeometry(geometry);
    for (RTCScene mesh : static_scenes_) rtcReleaseScene(mesh);
    for (RTCScene mesh : part_scenes_) rtcReleaseScene(mesh);
    rtcReleaseScene(top_);
    rtcReleaseDevice(device_);
  }

  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void set_sweep(double start_s, double end_s, const Eigen::Vector3d& place_world, double reach_m) {
    const double middle_s = 0.5 * (start_s + end_s);
    for (const Mover& mover : movers_) {
      const SceneObject& object = *mover.object;
      const ObjectModel& model = scene_.models[object.model];
      const SE3 T_world_middle = T_world_ground(scene_, object, middle_s);
      const double distance = (T_world_middle.translation() - place_world).norm();
      const bool near = distance < reach_m + model.size_lwh_m.norm();
      for (std::size_t i = 0; i < model.parts.size(); ++i) {
        RTCGeometry geometry = geometries_[mover.first_geometry + i];
        if (!near) {
          rtcDisableGeometry(geometry);
          continue;
        }
        rtcEnableGeometry(geometry);
        place(geometry, object, model.parts[i], start_s, end_s);
        rotations_[mover.first_geometry + i] = T_world_middle.rotation().toRotationMatrix();
        rtcCommitGeometry(geometry);
      }
    }
    rtcCommitScene(top_);
  }

  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double fraction,
                             double max_range_m) const {
    RTCRayHit query{};
    RTCRay& ray = query.ray;
    ray.org_x = static_cast<float>(origin.x());
    ray.org_y = static_cast<float>(origin.y());
    ray.org_z = static_cast<float>(origin.z());
    ray.dir_x = static_cast<float>(direction.x());
    ray.dir_y = static_cast<float>(direction.y());
    ray.dir_z = static_cast<float>(direction.z());
    ray.time = static_cast<float>(fraction);
    ray.tfar = static_cast<float>(max_range_m);
    ray.mask = ~0U;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(top_, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const std::size_t instance = query.hit.instID[0];
    const Eigen::Vector3d normal_mesh(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
    const Eigen::Vector3d normal = (rotations_[instance] * normal_mesh).normalized();
    return RayHit{.range_m = ray.tfar,
                  .cos_incidence = std::min(1.0, std::abs(normal.dot(direction))),
                  .surface = meshes_[instance]->triangles[query.hit.primID].surface,
                  .object_id = object_ids_[instance]};
  }

 private:
  struct Mover {
    const SceneObject* object;
    std::size_t first_geometry;
  };

  RTCScene add_mesh(const Mesh& mesh) {
    RTCScene scene = rtcNewScene(device_);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
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

  RTCGeometry add_instance(RTCScene mesh_scene, const Mesh& mesh, int object_id) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, mesh_scene);
    rtcAttachGeometryByID(top_, geometry, static_cast<unsigned>(geometries_.size()));
    geometries_.push_back(geometry);
    meshes_.push_back(&mesh);
    object_ids_.push_back(object_id);
    rotations_.push_back(Eigen::Matrix3d::Identity());
    return geometry;
  }

  void place(RTCGeometry geometry, const SceneObject& object, const ModelPart& part, double start_s,
             double end_s) const {
    const bool moves = object.motion.at(start_s).travelled_m != object.motion.at(end_s).travelled_m;
    const unsigned steps = moves ? kTimeSteps : 1;
    rtcSetGeometryTimeStepCount(geometry, steps);
    for (unsigned step = 0; step < steps; ++step) {
      const double time_s = start_s + (end_s - start_s) * step / (kTimeSteps - 1);
      const SE3 T_world_part =
          T_world_ground(scene_, object, time_s) * part.T_ground_part(object.motion.at(time_s).travelled_m);
      set_pose(geometry, step, T_world_part);
    }
  }

  const Scene& scene_;
  RTCDevice device_;
  RTCScene top_;
  std::vector<RTCScene> static_scenes_, part_scenes_;
  std::vector<std::size_t> first_part_;  // by model, in part_scenes_
  // by instance:
  std::vector<RTCGeometry> geometries_;
  std::vector<const Mesh*> meshes_;
  std::vector<int> object_ids_;
  std::vector<Eigen::Matrix3d>
      rotations_;  // for the incidence only: those of movers at the middle of the sweep
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
