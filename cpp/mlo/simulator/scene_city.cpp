#include <cmath>
#include <numbers>
#include <vector>

#include "mlo/simulator/scene.hpp"
#include "mlo/simulator/street.hpp"

namespace mlo::simulator {
namespace {

constexpr double kHalfWidth_m = 5.7;  // two lanes and two rows of parked cars
constexpr double kSidewalk_m = 2.8;
constexpr double kLane_m = 1.75;  // of a lane's middle from the centre line
constexpr double kTurnRadius_m = 11.0;
constexpr double kArm_m = 65.0;  // how far a street goes on beyond its junction
constexpr double kLeadIn_m = 30.0;

struct Block {
  double from_m, to_m;  // along the way
};

/// The robot's way: blocks joined by right-angled turns, never back in the direction it came from.
struct Plan {
  Path way;
  std::vector<Block> blocks;
};

Plan plan_way(Random& random, double length_m) {
  std::vector<PathPiece> pieces;
  Plan plan;
  int direction = 0;  // in right angles; -1, 0 or 1
  double s = 0.0;
  while (s < length_m + kLeadIn_m + kArm_m) {
    const double block = random.uniform(75.0, 120.0);
    plan.blocks.push_back({s, s + block});
    pieces.push_back({block, 0.0});
    const int turn = direction != 0 ? -direction : random.chance(0.5) ? 1 : -1;
    const double arc = 0.5 * std::numbers::pi * kTurnRadius_m;
    pieces.push_back({arc, turn / kTurnRadius_m});
    direction += turn;
    s += block + arc;
  }
  plan.way = Path(PathPoint{}, pieces, 7.0);
  return plan;
}

RedLight light_at(Random& random, double s_m) {
  return {
      .s_m = s_m, .period_s = 34.0, .red_s = random.uniform(9.0, 13.0), .phase_s = random.uniform(0.0, 34.0)};
}

/// Green for the cross street while the main street has red, with a pause between.
RedLight opposite(const RedLight& main, double s_m) {
  return {.s_m = s_m,
          .period_s = main.period_s,
          .red_s = main.period_s - main.red_s + 5.0,
          .phase_s = main.phase_s + main.red_s - 3.5};
}

struct Crossing {
  Street street;
  RedLight light;  // of the main street; s_m along the way
};

void furnish(SceneBuilder& builder, const Street& street, const PlantCatalogue& plants, std::size_t lamp,
             std::size_t sign, std::size_t bin) {
  line_with_buildings(builder, street, {});
  close_with_buildings(builder, street, {});
  line_with(builder, street,
            {.meshes = {lamp}, .offset_m = kHalfWidth_m + 0.5, .spacing_m = 28.0, .random_yaw = false});
  line_with(builder, street,
            {.meshes = plants.trees, .offset_m = kHalfWidth_m + 0.9, .spacing_m = 11.0, .density = 0.55});
  line_with(builder, street,
            {.meshes = {sign, bin},
             .offset_m = kHalfWidth_m + 0.45,
             .spacing_m = 17.0,
             .density = 0.4,
             .random_yaw = false});
  line_with(builder, street,
            {.meshes = plants.bushes,
             .offset_m = kHalfWidth_m + kSidewalk_m + 4.0,
             .spacing_m = 4.0,
             .density = 0.8,
             .keep_free = true});
  line_with(builder, street,
            {.meshes = plants.trees,
             .offset_m = kHalfWidth_m + kSidewalk_m + 9.0,
             .spacing_m = 7.0,
             .density = 0.7,
             .keep_free = true});
}

std::vector<RedLight> lights_along(const std::vector<Crossing>& crossings, bool oncoming,
                                   double way_length_m) {
  constexpr double kStopLine_m = kHalfWidth_m + 4.0;
  std::vector<RedLight> lights;
  for (const Crossing& crossing : crossings) {
    RedLight light = crossing.light;
    light.s_m = (oncoming ? way_length_m - light.s_m : light.s_m) - kStopLine_m;
    lights.push_back(light);
  }
  return lights;
}

void add_cross_traffic(SceneBuilder& builder, const Crossing& crossing, const ModelCatalogue& catalogue) {
  const double middle = 0.5 * crossing.street.centerline.length_m();
  for (const Path& direction : {crossing.street.centerline, crossing.street.centerline.reversed()}) {
    Lane lane{.path = direction.offset(-kLane_m), .spacing_m = 22.0, .speed_mps = 9.0};
    lane.lights = {opposite(crossing.light, middle - kHalfWidth_m - 4.0)};
    add_traffic(builder, lane, catalogue);
  }
}

}  // namespace

Scene make_city(const SceneOptions& options) {
  SceneBuilder builder("city", options.seed, rolling_terrain(Random(options.seed), 0.5, 140.0));
  Random& random = builder.random;
  const ModelCatalogue catalogue = add_catalogue(builder);
  const PlantCatalogue plants = add_plants(builder);
  const Plan plan = plan_way(random, options.length_m);

  std::vector<Street> streets;
  std::vector<Crossing> crossings;
  for (const Block& block : plan.blocks) {
    const double middle = 0.5 * (block.from_m + block.to_m);
    const PathPoint point = plan.way.at(middle);
    const double half = 0.5 * (block.to_m - block.from_m) + kTurnRadius_m + kArm_m;
    streets.push_back(
        add_street(builder, straight(point.p_world - half * point.ahead(), point.heading_rad, 2.0 * half),
                   kHalfWidth_m, kSidewalk_m));
    if (block.to_m - block.from_m > 90.0) {
      const Path across = straight(point.p_world - kArm_m * point.left(),
                                   point.heading_rad + 0.5 * std::numbers::pi, 2.0 * kArm_m);
      crossings.push_back({add_street(builder, across, kHalfWidth_m, kSidewalk_m), light_at(random, middle)});
    }
  }
  const std::size_t lamp = builder.add_mesh(make_lamp(7.5));
  const std::size_t sign = builder.add_mesh(make_sign());
  const std::size_t bin = builder.add_mesh(make_bin());
  for (const Crossing& crossing : crossings) streets.push_back(crossing.street);
  for (const Street& street : streets) furnish(builder, street, plants, lamp, sign, bin);

  const Lane own{.path = plan.way.offset(-kLane_m),
                 .spacing_m = 24.0,
                 .speed_mps = 9.0,
                 .lights = lights_along(crossings, false, plan.way.length_m())};
  add_robot_lane(builder, {.lane = own, .s_start_m = kLeadIn_m, .length_m = options.length_m}, catalogue);
  const Lane oncoming{.path = plan.way.reversed().offset(-kLane_m),
                      .spacing_m = 32.0,
                      .speed_mps = 9.0,
                      .lights = lights_along(crossings, true, plan.way.length_m())};
  add_traffic(builder, oncoming, catalogue);
  for (const Crossing& crossing : crossings) add_cross_traffic(builder, crossing, catalogue);
  for (const Street& street : streets) {
    park_along(builder, street, catalogue, 0.6);
    add_crossers(builder, street, catalogue, 3);
    add_walkers(builder, street, catalogue, 16.0);
  }
  add_cyclists(builder, plan.way, catalogue, kHalfWidth_m - 2.9);
  return builder.finish(plan.way.part(0.0, kLeadIn_m + options.length_m), 0.03);
}

}  // namespace mlo::simulator
