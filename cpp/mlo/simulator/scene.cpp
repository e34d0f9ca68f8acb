#include "mlo/simulator/scene.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "mlo/core/error.hpp"

namespace mlo::simulator {

SE3 T_world_ground(const Scene& scene, const SceneObject& object, double time_s) {
  const PlanarState state = object.motion.at(time_s);
  const bool upright = scene.models[object.model].object_class == ObjectClass::pedestrian;
  return upright ? stand_upright_on(scene.terrain, state.p_world, state.yaw_rad, object.lift_m)
                 : stand_on(scene.terrain, state.p_world, state.yaw_rad, object.lift_m);
}

SE3 T_world_object(const Scene& scene, const SceneObject& object, double time_s) {
  const double half_height = 0.5 * scene.models[object.model].size_lwh_m.z();
  return T_world_ground(scene, object, time_s) * SE3(Eigen::Quaterniond::Identity(), {0.0, 0.0, half_height});
}

std::string_view name_of(SceneKind kind) {
  const auto scene = std::ranges::find(kScenes, kind, &NamedScene::kind);
  return scene == kScenes.end() ? "" : scene->name;
}

Scene make_scene(const SceneOptions& options) {
  constexpr double kShortest_m = 1.0;
  constexpr double kLongest_m = 20000.0;
  if (!(options.length_m >= kShortest_m && options.length_m <= kLongest_m)) {
    throw InputError(fmt::format("simulate: length is {} m; choose {} to {} m", options.length_m, kShortest_m,
                                 kLongest_m));
  }
  switch (options.kind) {
    case SceneKind::city:
      return make_city(options);
    case SceneKind::suburb:
      return make_suburb(options);
    case SceneKind::highway:
      return make_highway(options);
    case SceneKind::tunnel:
      return make_tunnel(options);
    case SceneKind::train:
      return make_train(options);
    case SceneKind::jam:
      return make_jam(options);
    case SceneKind::parking:
      return make_parking(options);
  }
  throw InputError("simulate: unknown scene");
}

}  // namespace mlo::simulator
