#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mlo/simulator/scene.hpp"
#include "mlo/simulator/street.hpp"

namespace mlo::simulator {
namespace {

constexpr double kHalfWidth_m = 13.0;  // median, three lanes each way
constexpr double kSidewalk_m = 2.8;
constexpr double kInnerLane_m = 3.2;  // middle of the innermost lane
constexpr double kLaneWidth_m = 3.3;
constexpr double kLeadIn_m = 90.0;

/// Speed of the head of a queue [m/s]: it creeps at up to 2 m/s and stands still in between.
std::function<double(double)> stop_and_go(Random& random) {
  const double period_s = random.uniform(18.0, 30.0);
  const double phase = random.uniform(0.0, 2.0 * std::numbers::pi);
  return [=](double time_s) {
    return std::max(0.0, 0.7 + 1.3 * std::sin(2.0 * std::numbers::pi * time_s / period_s + phase));
  };
}

/// Vehicles one behind the other; the foremost sets the pace. Returns the drivers and their models.
struct Column {
  std::vector<Driver> drivers;
  std::vector<std::size_t> models;
};

Column queue_up(SceneBuilder& builder, const ModelCatalogue& catalogue, double from_m, double to_m) {
  Random& random = builder.random;
  Column column;
  const std::function<double(double)> head = stop_and_go(random);
  const auto creep = [](double) { return 2.0; };
  for (double rear = to_m; rear > from_m;) {
    const std::size_t model = catalogue.vehicle(random, 0.06);
    const double length = builder.scene.models[model].size_lwh_m.x();
    const bool first = column.drivers.empty();
    column.drivers.push_back(
        {rear - 0.5 * length, length, 0.0, first ? head : std::function<double(double)>(creep)});
    column.models.push_back(model);
    rear -= length + random.uniform(2.2, 4.5);
  }
  return column;
}

constexpr TrafficRules kCreeping{.max_acceleration_mps2 = 0.9, .gap_s = 1.0, .standstill_gap_m = 1.8};

/// Adds the robot in place of the vehicle nearest to s_m, and all others of its lane.
void add_robot_column(SceneBuilder& builder, const Path& lane, const Column& column, double s_m,
                      double length_m) {
  const auto distance = [&](const Driver& driver) { return std::abs(driver.s_start_m - s_m); };
  const auto nearest = std::ranges::min_element(column.drivers, {}, distance);
  const auto robot = static_cast<std::size_t>(nearest - column.drivers.begin());
  const double patience_s = 4.0 * length_m + 60.0;
  const std::vector<Motion> motions = drive_lane(lane, column.drivers, {}, kCreeping, patience_s);
  const std::vector<PlanarState>& states = motions[robot].states();
  const auto arrival =
      std::ranges::find_if(states, [&](const PlanarState& state) { return state.travelled_m >= length_m; });
  builder.set_robot(motions[robot], Motion::kStep_s * static_cast<double>(arrival - states.begin()));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (i != robot) builder.add_object(column.models[i], motions[i]);
  }
}

void add_column(SceneBuilder& builder, const Path& lane, const Column& column) {
  const std::vector<Motion> motions =
      drive_lane(lane, column.drivers, {}, kCreeping, builder.scene.duration_s);
  for (std::size_t i = 0; i < motions.size(); ++i) builder.add_object(column.models[i], motions[i]);
}

void furnish(SceneBuilder& builder, const Street& street) {
  const PlantCatalogue plants = add_plants(builder);
  line_with_buildings(builder, street, {.min_storeys = 3, .max_storeys = 6});
  line_with(builder, street,
            {.meshes = {builder.add_mesh(make_lamp(9.0))},
             .offset_m = kHalfWidth_m + 0.5,
             .spacing_m = 30.0,
             .random_yaw = false});
  line_with(builder, street,
            {.meshes = plants.trees, .offset_m = kHalfWidth_m + 1.0, .spacing_m = 12.0, .density = 0.6});
  line_with(builder, street, {.meshes = plants.bushes, .offset_m = 0.5, .spacing_m = 3.0, .density = 0.8});
  line_with(builder, street,
            {.meshes = {builder.add_mesh(make_sign()), builder.add_mesh(make_bin())},
             .offset_m = kHalfWidth_m + 0.45,
             .spacing_m = 19.0,
             .density = 0.5,
             .random_yaw = false});
}

}  // namespace

Scene make_jam(const SceneOptions& options) {
  SceneBuilder builder("jam", options.seed, rolling_terrain(Random(options.seed), 0.4, 160.0));
  Random& random = builder.random;
  const ModelCatalogue catalogue = add_catalogue(builder);
  const double total = options.length_m + 2.0 * kLeadIn_m;
  const Path way(PathPoint{}, {{0.5 * total, 0.0}, {0.5 * total, random.uniform(-1.0, 1.0) / 250.0}}, 30.0);
  const Street street = add_street(builder, way, kHalfWidth_m, kSidewalk_m);
  furnish(builder, street);

  // queues reach as far ahead as the lidar sees; their heads creep on
  const auto lane = [&](int index) { return way.offset(-kInnerLane_m - kLaneWidth_m * index); };
  const double head = 2.0 * kLeadIn_m;
  add_robot_column(builder, lane(1), queue_up(builder, catalogue, 10.0, head), kLeadIn_m, options.length_m);
  for (const int index : {0, 2}) add_column(builder, lane(index), queue_up(builder, catalogue, 10.0, head));
  for (const int index : {0, 1}) {
    add_traffic(builder,
                {.path = way.reversed().offset(-kInnerLane_m - kLaneWidth_m * index),
                 .spacing_m = 45.0,
                 .speed_mps = 12.0},
                catalogue);
  }
  add_walkers(builder, street, catalogue, 14.0);
  return builder.finish(way, 0.03);
}

}  // namespace mlo::simulator
