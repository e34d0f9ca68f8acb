#include "mlo/simulator/scene_builder.hpp"

#include <algorithm>
#include <utility>

#include "mlo/simulator/structures.hpp"

namespace mlo::simulator {
namespace {

Footprint footprint_at(const Motion& motion, double time_s, Footprint size) {
  const PlanarState state = motion.at(time_s);
  size.center = state.p_world;
  size.yaw_rad = state.yaw_rad;
  return size;
}

constexpr double kRobotLength_m = 4.9;
constexpr double kRobotWidth_m = 1.9;
constexpr double kClearance_m = 0.25;

}  // namespace

SceneBuilder::SceneBuilder(std::string name, std::uint64_t seed, Terrain terrain)
    : random(mix(seed, 0x5CE7E)) {
  scene.name = std::move(name);
  scene.terrain = std::move(terrain);
}

std::size_t SceneBuilder::add_mesh(Mesh mesh) {
  scene.meshes.push_back(std::move(mesh));
  return scene.meshes.size() - 1;
}

void SceneBuilder::stand(std::size_t mesh, const Eigen::Vector2d& p_world, double yaw_rad, double lift_m) {
  place(mesh, stand_upright_on(scene.terrain, p_world, yaw_rad, lift_m));
}

std::size_t SceneBuilder::add_model(ObjectModel model) {
  scene.models.push_back(std::move(model));
  return scene.models.size() - 1;
}

void SceneBuilder::set_robot(const Motion& motion, double duration_s) {
  scene.robot.planar = motion;
  scene.robot.suspension.phase_rad = random.uniform(0.0, 100.0);
  scene.duration_s = duration_s;
}

bool SceneBuilder::collides(const Motion& motion, const Footprint& size, const Motion& other,
                            const Footprint& other_size) const {
  constexpr double kStep_s = 0.2;
  constexpr double kFastest_mps = 100.0;  // at which two can approach each other
  const bool moves = motion.ever_moves() || other.ever_moves();
  const auto num_steps = moves ? static_cast<std::size_t>(scene.duration_s / kStep_s) : 0;
  const double reach_m = size.length_m + size.width_m + other_size.length_m + other_size.width_m;
  for (std::size_t step = 0; step <= num_steps;) {
    const double t = static_cast<double>(step) * kStep_s;
    const Footprint a = footprint_at(motion, t, size);
    const Footprint b = footprint_at(other, t, other_size);
    if (overlap(a, b, kClearance_m)) return true;
    // Those far apart need not be looked at until they can be near.
    const double apart_m = std::max(0.0, (a.center - b.center).norm() - reach_m);
    step += 1 + static_cast<std::size_t>(apart_m / (kFastest_mps * kStep_s));
  }
  return false;
}

bool SceneBuilder::add_object(std::size_t model, const Motion& motion, double lift_m, bool detectable) {
  const auto size_of = [&](std::size_t m) {
    const Eigen::Vector3d& size = scene.models[m].size_lwh_m;
    return Footprint{{0.0, 0.0}, 0.0, size.x(), size.y()};
  };
  const Footprint size = size_of(model);
  const Footprint robot{{0.0, 0.0}, 0.0, kRobotLength_m, kRobotWidth_m};
  if (collides(motion, size, scene.robot.planar, robot)) return false;
  const bool blocked = std::ranges::any_of(scene.objects, [&](const SceneObject& other) {
    return collides(motion, size, other.motion, size_of(other.model));
  });
  if (blocked) return false;
  const int id = static_cast<int>(scene.objects.size()) + 1;
  scene.objects.push_back({id, model, motion, lift_m, detectable});
  return true;
}

Scene SceneBuilder::finish(const Path& way, double roughness_m) {
  constexpr double kReach_m = 100.0;
  constexpr double kCell_m = 1.5;
  place_world(site.ground(scene.terrain, way, kReach_m, kCell_m, roughness_m, random.bits()));
  place_world(site.sidewalks(scene.terrain));
  return std::move(scene);
}

std::size_t pick(Random& random, const std::vector<std::size_t>& choices) {
  return choices[static_cast<std::size_t>(random.integer(0, static_cast<int>(choices.size()) - 1))];
}

std::size_t ModelCatalogue::vehicle(Random& random, double truck_share) const {
  if (random.chance(truck_share)) return pick(random, trucks);
  return random.chance(0.12) ? pick(random, vans) : pick(random, cars);
}

ModelCatalogue add_catalogue(SceneBuilder& builder) {
  ModelCatalogue catalogue;
  const auto add = [&](std::vector<std::size_t>& list, int count, auto make) {
    for (int i = 0; i < count; ++i) list.push_back(builder.add_model(make(Random(builder.random.bits()))));
  };
  add(catalogue.cars, 12, make_car);
  add(catalogue.vans, 4, make_van);
  add(catalogue.trucks, 4, make_truck);
  add(catalogue.pedestrians, 6, make_pedestrian);
  add(catalogue.cyclists, 4, make_cyclist);
  return catalogue;
}

PlantCatalogue add_plants(SceneBuilder& builder) {
  PlantCatalogue plants;
  Random& random = builder.random;
  for (int i = 0; i < 6; ++i) {
    const double height = random.uniform(5.0, 13.0);
    plants.trees.push_back(
        builder.add_mesh(make_tree(height, height * random.uniform(0.22, 0.32), Random(random.bits()))));
  }
  for (int i = 0; i < 4; ++i) {
    plants.bushes.push_back(builder.add_mesh(
        make_bush(random.uniform(0.6, 1.6), random.uniform(0.9, 2.4), Random(random.bits()))));
    plants.hedges.push_back(
        builder.add_mesh(make_hedge(PlantCatalogue::kHedgeLength_m, random.uniform(0.6, 0.9),
                                    random.uniform(1.1, 2.0), Random(random.bits()))));
  }
  return plants;
}

}  // namespace mlo::simulator
