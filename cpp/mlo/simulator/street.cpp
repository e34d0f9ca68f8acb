#include "mlo/simulator/street.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mlo::simulator {
namespace {

using Eigen::Vector2d;

constexpr double kSides[] = {-1.0, 1.0};

/// Heading of something at the side of a street whose +y points to the street.
double facing_street(const PathPoint& point, double side) {
  return side > 0.0 ? point.heading_rad + std::numbers::pi : point.heading_rad;
}

BuildingShape random_building(Random& random, const Frontage& frontage, double width, double depth) {
  BuildingShape shape;
  shape.width_m = width;
  shape.depth_m = depth;
  shape.storey_m = random.uniform(2.8, 3.4);
  shape.storeys = random.integer(frontage.min_storeys, frontage.max_storeys);
  shape.window_width_m = random.uniform(0.9, 1.6);
  shape.window_gap_m = random.uniform(0.8, 1.8);
  shape.roof_rise_m = frontage.roof_rise_m * random.uniform(0.8, 1.2);
  shape.balconies = random.chance(0.35);
  return shape;
}

/// A building on a free lot; its front (-y of its own frame) looks against the yaw's left.
void build(SceneBuilder& builder, const Frontage& frontage, const Footprint& lot, double yaw) {
  if (!builder.site.is_free(lot)) return;
  builder.site.take(lot);
  const BuildingShape shape = random_building(builder.random, frontage, lot.length_m, lot.width_m);
  builder.stand(builder.add_mesh(make_building(shape)), lot.center, yaw);
}

void build_lot(SceneBuilder& builder, const Street& street, const Frontage& frontage, double s, double side,
               double width) {
  Random& random = builder.random;
  const double depth = random.uniform(frontage.min_depth_m, frontage.max_depth_m);
  const PathPoint point = street.centerline.at(s);
  const double offset = street.half_width_m + street.sidewalk_m +
                        frontage.setback_m * random.uniform(0.7, 1.3) + 0.5 * depth + 0.3;
  build(builder, frontage, {point.p_world + side * offset * point.left(), point.heading_rad, width, depth},
        facing_street(point, side));
}

}  // namespace

Street add_street(SceneBuilder& builder, const Path& centerline, double half_width_m, double sidewalk_m) {
  const std::size_t road = builder.site.add_road(centerline, half_width_m, sidewalk_m);
  return {centerline, road, half_width_m, sidewalk_m};
}

void line_with_buildings(SceneBuilder& builder, const Street& street, const Frontage& frontage) {
  Random& random = builder.random;
  for (const double side : kSides) {
    double s = random.uniform(0.0, 5.0);
    while (s < street.centerline.length_m()) {
      const double width = random.uniform(frontage.min_width_m, frontage.max_width_m);
      if (!random.chance(frontage.vacancy))
        build_lot(builder, street, frontage, s + 0.5 * width, side, width);
      s += width + 0.15 + frontage.gap_m * random.uniform(0.7, 1.5);
    }
  }
}

void close_with_buildings(SceneBuilder& builder, const Street& street, const Frontage& frontage) {
  constexpr double kBeyond_m = 5.0;
  for (const Path& way : {street.centerline, street.centerline.reversed()}) {
    const double width = 2.0 * (street.half_width_m + street.sidewalk_m) + 4.0;
    const PathPoint end =
        way.at(way.length_m() + street.half_width_m + kBeyond_m + 0.5 * frontage.min_depth_m);
    const double yaw = end.heading_rad - 0.5 * std::numbers::pi;
    build(builder, frontage, {end.p_world, yaw, width, frontage.min_depth_m}, yaw);
  }
}

void line_with(SceneBuilder& builder, const Street& street, const Row& row) {
  Random& random = builder.random;
  constexpr double kMargin_m = 1.0;
  for (const double side : kSides) {
    for (double s = random.uniform(0.0, row.spacing_m); s < street.centerline.length_m();
         s += row.spacing_m) {
      const std::size_t mesh = pick(random, row.meshes);
      const double turn = random.uniform(0.0, 2.0 * std::numbers::pi);
      if (!random.chance(row.density)) continue;
      const PathPoint point = street.centerline.at(s);
      const Vector2d p = point.p_world + side * row.offset_m * point.left();
      if (builder.site.near_another_road(p, street.road, kMargin_m)) continue;
      const Footprint small{p, 0.0, 1.0, 1.0};
      if (row.keep_free && !builder.site.is_free(small)) continue;
      if (row.keep_free) builder.site.take(small);
      const bool on_kerb = row.offset_m < street.half_width_m + street.sidewalk_m;
      builder.stand(mesh, p, row.random_yaw ? turn : facing_street(point, side),
                    on_kerb ? Site::kKerb_m : 0.0);
    }
  }
}

void park_along(SceneBuilder& builder, const Street& street, const ModelCatalogue& catalogue,
                double occupancy) {
  Random& random = builder.random;
  constexpr double kJunction_m = 6.0;  // no parking near a junction
  for (const double side : kSides) {
    for (double s = random.uniform(0.0, 6.0); s < street.centerline.length_m();
         s += random.uniform(5.6, 6.6)) {
      if (!random.chance(occupancy)) continue;
      const PathPoint point = street.centerline.at(s);
      const double offset = side * (street.half_width_m - 1.1 + random.uniform(-0.1, 0.1));
      const Vector2d p = point.p_world + offset * point.left();
      if (builder.site.near_another_road(p, street.road, kJunction_m)) continue;
      const double against = random.chance(0.1) ? std::numbers::pi : 0.0;
      const double heading = point.heading_rad + (side > 0.0 ? std::numbers::pi : 0.0) + against;
      builder.park(catalogue.vehicle(random, 0.01), p, heading + random.uniform(-0.03, 0.03));
    }
  }
}

void add_walkers(SceneBuilder& builder, const Street& street, const ModelCatalogue& catalogue,
                 double spacing_m) {
  Random& random = builder.random;
  const double duration = builder.scene.duration_s;
  for (const double side : kSides) {
    for (double s = random.uniform(0.0, spacing_m); s < street.centerline.length_m();
         s += spacing_m * random.uniform(0.5, 1.5)) {
      const double offset = side * (street.half_width_m + street.sidewalk_m * random.uniform(0.5, 0.8));
      const Path track = street.centerline.offset(offset);
      const std::size_t model = pick(random, catalogue.pedestrians);
      if (random.chance(0.2)) {
        const PathPoint point = track.at(s);
        builder.park(model, point.p_world, random.uniform(0.0, 2.0 * std::numbers::pi), Site::kKerb_m);
        continue;
      }
      const double speed = random.uniform(0.9, 1.6);
      const bool back = random.chance(0.5);
      const Path way = back ? track.reversed() : track;
      builder.add_object(model, cruise(way, back ? way.length_m() - s : s, speed, duration), Site::kKerb_m);
    }
  }
}

void add_crossers(SceneBuilder& builder, const Street& street, const ModelCatalogue& catalogue, int count) {
  Random& random = builder.random;
  for (int i = 0; i < count; ++i) {
    const PathPoint point = street.centerline.at(random.uniform(0.0, street.centerline.length_m()));
    const double half = street.half_width_m + 0.5 * street.sidewalk_m;
    const double side = random.chance(0.5) ? 1.0 : -1.0;
    const Path way = straight(point.p_world - side * half * point.left(),
                              point.heading_rad + side * 0.5 * std::numbers::pi, 2.0 * half);
    const Motion motion = glide(way, random.uniform(1.1, 1.7), random.uniform(0.0, builder.scene.duration_s));
    builder.add_object(pick(random, catalogue.pedestrians), motion, 0.5 * Site::kKerb_m);
  }
}

void add_cyclists(SceneBuilder& builder, const Path& way, const ModelCatalogue& catalogue, double offset_m,
                  double spacing_m) {
  Random& random = builder.random;
  for (const Path& direction : {way, way.reversed()}) {
    const Path track = direction.offset(-offset_m);
    for (double s = random.uniform(0.0, spacing_m); s < track.length_m();
         s += spacing_m * random.uniform(0.6, 1.4)) {
      const Motion motion = cruise(track, s, random.uniform(3.5, 6.0), builder.scene.duration_s);
      builder.add_object(pick(random, catalogue.cyclists), motion);
    }
  }
}

namespace {

struct Queue {
  std::vector<Driver> drivers;
  std::vector<std::size_t> models;
};

void append_driver(Queue& queue, SceneBuilder& builder, const Lane& lane, const ModelCatalogue& catalogue,
                   double s) {
  Random& random = builder.random;
  const std::size_t model = catalogue.vehicle(random, lane.truck_share);
  const double speed = std::max(0.5, lane.speed_mps + lane.speed_spread_mps * random.uniform(-1.0, 1.0));
  queue.models.push_back(model);
  queue.drivers.push_back(
      {s, builder.scene.models[model].size_lwh_m.x(), 0.8 * speed, [speed](double) { return speed; }});
}

}  // namespace

void add_traffic(SceneBuilder& builder, const Lane& lane, const ModelCatalogue& catalogue) {
  Random& random = builder.random;
  Queue queue;
  // also before the lane's begin: they come into view later
  const double first = -lane.speed_mps * builder.scene.duration_s;
  for (double s = lane.path.length_m() - 5.0; s > first;
       s -= lane.spacing_m * random.uniform(0.6, 1.6) + 6.0) {
    append_driver(queue, builder, lane, catalogue, s);
  }
  const std::vector<Motion> motions =
      drive_lane(lane.path, queue.drivers, lane.lights, TrafficRules{}, builder.scene.duration_s);
  for (std::size_t i = 0; i < motions.size(); ++i) builder.add_object(queue.models[i], motions[i]);
}

void add_robot_lane(SceneBuilder& builder, const RobotDrive& drive, const ModelCatalogue& catalogue) {
  Random& random = builder.random;
  const Lane& lane = drive.lane;
  Queue queue;
  const auto gap = [&] { return std::max(8.5, lane.spacing_m * random.uniform(0.6, 1.4)); };
  double s = drive.s_start_m;
  std::vector<double> places;
  for (int i = 0; i < drive.ahead; ++i) places.insert(places.begin(), s += gap());
  for (const double place : places) append_driver(queue, builder, lane, catalogue, place);
  const std::size_t robot = queue.drivers.size();
  append_driver(queue, builder, lane, catalogue, s = drive.s_start_m);
  for (int i = 0; i < drive.behind; ++i) append_driver(queue, builder, lane, catalogue, s -= gap());

  const double patience_s = 3.0 * drive.length_m / lane.speed_mps + 120.0;
  std::vector<Motion> motions = drive_lane(lane.path, queue.drivers, lane.lights, TrafficRules{}, patience_s);
  const std::vector<PlanarState>& states = motions[robot].states();
  const auto arrival = std::ranges::find_if(
      states, [&](const PlanarState& state) { return state.travelled_m >= drive.length_m; });
  builder.set_robot(motions[robot], Motion::kStep_s * static_cast<double>(arrival - states.begin()));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (i != robot) builder.add_object(queue.models[i], motions[i]);
  }
}

Terrain rolling_terrain(Random random, double amplitude_m, double wavelength_m) {
  Terrain terrain;
  for (int i = 0; i < 4; ++i) {
    const double angle = std::numbers::pi * (i + random.uniform(0.0, 0.8)) / 4.0;
    const double wave_number = 2.0 * std::numbers::pi / (wavelength_m * random.uniform(0.7, 1.4));
    terrain.waves.push_back({wave_number * Vector2d(std::cos(angle), std::sin(angle)),
                             0.5 * amplitude_m * random.uniform(0.6, 1.0),
                             random.uniform(0.0, 2.0 * std::numbers::pi)});
  }
  return terrain;
}

}  // namespace mlo::simulator
