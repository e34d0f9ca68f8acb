#include "mlo/scene/scene_state.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

/// The scans around a moment, and how far from the first to the second it is.
struct Place {
  std::size_t before = 0;
  std::size_t after = 0;
  double fraction = 0.0;
};

Place find_place(const SceneFile& scene, double stamp_s) {
  const std::size_t count = scene.num_scans();
  for (std::size_t i = 0; i < count; ++i) {
    if (scene.stamp_s(i) == stamp_s) return {i, i, 0.0};
  }
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const double start_s = scene.stamp_s(i);
    const double end_s = scene.stamp_s(i + 1);
    if (start_s < stamp_s && stamp_s < end_s) return {i, i + 1, (stamp_s - start_s) / (end_s - start_s)};
  }
  if (count == 0) throw InputError(fmt::format("{}: holds no scan", scene.path().string()));
  throw InputError(fmt::format("{}: {} s is not within the scene, which lasts from {:.6f} s to {:.6f} s",
                               scene.path().string(), stamp_s, scene.stamp_s(0), scene.stamp_s(count - 1)));
}

SE3 between(const SE3& before, const SE3& after, double fraction) {
  return before * interpolate(before.inverse() * after, fraction);
}

SceneObject between(const SceneObject& before, const SceneObject& after, double fraction) {
  SceneObject object = fraction < 0.5 ? before : after;
  object.T_map_object = between(before.T_map_object, after.T_map_object, fraction);
  object.velocity_map_mps +=
      (fraction - (fraction < 0.5 ? 0.0 : 1.0)) * (after.velocity_map_mps - before.velocity_map_mps);
  return object;
}

}  // namespace

SceneState state_at(const SceneFile& scene, double stamp_s) {
  const Place place = find_place(scene, stamp_s);
  const SceneScan before = scene.scan(place.before);
  const SceneScan after = place.after == place.before ? before : scene.scan(place.after);
  const SceneScan& nearest = place.fraction < 0.5 ? before : after;
  const SceneScan& other = place.fraction < 0.5 ? after : before;

  SceneState state{.stamp_s = stamp_s, .frame = nearest.frame, .status = nearest.status};
  state.T_map_lidar = between(before.T_map_lidar, after.T_map_lidar, place.fraction);
  state.covariance = nearest.covariance;
  for (const SceneObject& object : nearest.objects) {
    const auto same = std::find_if(other.objects.begin(), other.objects.end(),
                                   [&](const SceneObject& candidate) { return candidate.id == object.id; });
    if (same == other.objects.end()) {
      state.objects.push_back(object);
    } else if (place.fraction < 0.5) {
      state.objects.push_back(between(object, *same, place.fraction));
    } else {
      state.objects.push_back(between(*same, object, place.fraction));
    }
  }
  return state;
}

}  // namespace mlo
