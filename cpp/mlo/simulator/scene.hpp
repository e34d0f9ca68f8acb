#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/simulator/mesh.hpp"
#include "mlo/simulator/motion.hpp"
#include "mlo/simulator/object_model.hpp"
#include "mlo/simulator/terrain.hpp"

namespace mlo::simulator {

/// A mesh that never moves.
struct StaticPart {
  std::size_t mesh = 0;  ///< in Scene::meshes
  SE3 T_world_mesh;
};

/// Something that moves or could.
struct SceneObject {
  int id = 0;             ///< from 1
  std::size_t model = 0;  ///< in Scene::models
  Motion motion;
  double lift_m = 0.0;     ///< above the terrain: kerbs, rails
  bool detectable = true;  ///< false: no detector reports it
};

/// A world with a robot driving through it. World frame: z up, origin anywhere.
struct Scene {
  std::string name;
  Terrain terrain;
  std::vector<Mesh> meshes;
  std::vector<StaticPart> statics;
  std::vector<ObjectModel> models;
  std::vector<SceneObject> objects;
  RobotMotion robot;
  double duration_s = 0.0;
};

/// Pose of an object's ground frame (under the middle of its box, z up from the ground).
SE3 T_world_ground(const Scene& scene, const SceneObject& object, double time_s);
/// Pose of an object's body-fixed frame: origin at the centre of its box.
SE3 T_world_object(const Scene& scene, const SceneObject& object, double time_s);

enum class SceneKind { city, suburb, highway, tunnel, train, jam, parking };

struct SceneOptions {
  SceneKind kind = SceneKind::city;
  double length_m = 300.0;  ///< of the robot's way
  std::uint64_t seed = 1;
};

struct NamedScene {
  std::string_view name;
  SceneKind kind;
};
/// All kinds, with their names.
constexpr std::array<NamedScene, 7> kScenes{{{"city", SceneKind::city},
                                             {"suburb", SceneKind::suburb},
                                             {"highway", SceneKind::highway},
                                             {"tunnel", SceneKind::tunnel},
                                             {"train", SceneKind::train},
                                             {"jam", SceneKind::jam},
                                             {"parking", SceneKind::parking}}};
std::string_view name_of(SceneKind kind);

/// @throws InputError when the length is too short or too long for the scene
Scene make_scene(const SceneOptions& options);

// One file per kind (scene_<kind>.cpp).
Scene make_city(const SceneOptions& options);
Scene make_suburb(const SceneOptions& options);
Scene make_highway(const SceneOptions& options);
Scene make_tunnel(const SceneOptions& options);
Scene make_train(const SceneOptions& options);
Scene make_jam(const SceneOptions& options);
Scene make_parking(const SceneOptions& options);

}  // namespace mlo::simulator
