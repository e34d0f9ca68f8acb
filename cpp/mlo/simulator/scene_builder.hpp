#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mlo/simulator/scene.hpp"
#include "mlo/simulator/site.hpp"

namespace mlo::simulator {

/// Puts a scene together: keeps the plan of the site, and refuses objects that would run into others.
class SceneBuilder {
 public:
  SceneBuilder(std::string name, std::uint64_t seed, Terrain terrain);

  Scene scene;
  Site site;
  Random random;

  std::size_t add_mesh(Mesh mesh);
  void place(std::size_t mesh, const SE3& T_world_mesh) { scene.statics.push_back({mesh, T_world_mesh}); }
  /// On the ground and upright.
  void stand(std::size_t mesh, const Eigen::Vector2d& p_world, double yaw_rad, double lift_m = 0.0);
  /// A mesh in world coordinates.
  void place_world(Mesh mesh) { place(add_mesh(std::move(mesh)), SE3()); }
  std::size_t add_model(ObjectModel model);

  /// The robot's motion, which all others must respect. Call before adding objects.
  void set_robot(const Motion& motion, double duration_s);
  /// Adds an object unless it would touch the robot or an object added before, at any time.
  bool add_object(std::size_t model, const Motion& motion, double lift_m = 0.0, bool detectable = true);
  /// Adds an object at rest.
  bool park(std::size_t model, const Eigen::Vector2d& p_world, double yaw_rad, double lift_m = 0.0) {
    return add_object(model, Motion::at_rest(p_world, yaw_rad), lift_m);
  }

  /// The finished scene: adds the ground and sidewalks around the way.
  Scene finish(const Path& way, double roughness_m);

 private:
  bool collides(const Motion& motion, const Footprint& size, const Motion& other,
                const Footprint& other_size) const;
};

/// Some of each kind, for streets: indices into Scene::models.
struct ModelCatalogue {
  std::vector<std::size_t> cars, vans, trucks, pedestrians, cyclists;

  /// What drives on streets: mostly cars, some vans, few trucks.
  std::size_t vehicle(Random& random, double truck_share = 0.05) const;
};
ModelCatalogue add_catalogue(SceneBuilder& builder);

/// Tree, bush and hedge meshes to choose from: indices into Scene::meshes.
struct PlantCatalogue {
  std::vector<std::size_t> trees, bushes, hedges;
  static constexpr double kHedgeLength_m = 4.0;
};
PlantCatalogue add_plants(SceneBuilder& builder);

std::size_t pick(Random& random, const std::vector<std::size_t>& choices);

}  // namespace mlo::simulator
