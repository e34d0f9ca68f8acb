#include <numbers>
#include <vector>

#include "mlo/simulator/scene.hpp"
#include "mlo/simulator/street.hpp"

namespace mlo::simulator {
namespace {

constexpr double kHalfWidth_m = 12.6;  // half of the median, two lanes and the hard shoulder
constexpr double kFastLane_m = 3.9;    // lane middles, from the middle of the median
constexpr double kSlowLane_m = 7.65;
constexpr double kLeadIn_m = 250.0;  // traffic behind and ahead comes from there
constexpr double kSpeed_mps = 25.0;

Path plan_way(Random& random, double length_m) {
  std::vector<PathPiece> pieces;
  const double total = length_m + 2.0 * kLeadIn_m;
  for (double s = 0.0; s < total;) {
    const double piece = random.uniform(150.0, 350.0);
    pieces.push_back({piece, random.chance(0.3) ? 0.0 : random.uniform(-1.0, 1.0) / 600.0});
    s += piece;
  }
  return Path(PathPoint{}, pieces, 80.0);
}

void add_barriers(SceneBuilder& builder, const Path& way) {
  const Terrain& terrain = builder.scene.terrain;
  const std::vector<Surface> concrete(3, Surface::barrier);
  // New Jersey barrier in the median
  builder.place_world(
      extrude(terrain, way, {{-0.3, 0.0}, {-0.1, 0.9}, {0.1, 0.9}, {0.3, 0.0}}, concrete, 4.0));
  const std::size_t post =
      builder.add_mesh(cuboid({-0.05, -0.05, -0.4}, {0.05, 0.05, 0.72}, Surface::barrier));
  for (const double side : {-1.0, 1.0}) {
    const double y = side * (kHalfWidth_m + 0.3);
    // guard rail: a beam with a fold
    builder.place_world(extrude(
        terrain, way, {{y, 0.44}, {y - 0.07 * side, 0.52}, {y, 0.6}, {y - 0.07 * side, 0.68}, {y, 0.76}},
        {Surface::barrier, Surface::barrier, Surface::barrier, Surface::barrier}, 4.0));
    for (double s = 0.0; s < way.length_m(); s += 4.0) {
      const PathPoint point = way.at(s);
      builder.stand(post, point.p_world + (y + 0.1 * side) * point.left(), point.heading_rad);
    }
  }
}

void add_noise_walls(SceneBuilder& builder, const Path& way) {
  Random& random = builder.random;
  for (const double side : {-1.0, 1.0}) {
    const double from = kLeadIn_m + random.uniform(0.1, 0.6) * (way.length_m() - 2.0 * kLeadIn_m);
    const double y = side * (kHalfWidth_m + 3.0);
    const Path part = way.part(from, from + random.uniform(60.0, 140.0));
    builder.place_world(extrude(builder.scene.terrain, part, {{y, -0.3}, {y, 3.6}}, {Surface::wall}, 4.0));
  }
}

}  // namespace

Scene make_highway(const SceneOptions& options) {
  SceneBuilder builder("highway", options.seed, rolling_terrain(Random(options.seed), 3.0, 420.0));
  Random& random = builder.random;
  const ModelCatalogue catalogue = add_catalogue(builder);
  const PlantCatalogue plants = add_plants(builder);
  const Path way = plan_way(random, options.length_m);
  const Street street = add_street(builder, way, kHalfWidth_m, 0.0);

  add_barriers(builder, way);
  add_noise_walls(builder, way);
  const std::size_t gantry = builder.add_mesh(make_gantry(2.0 * kHalfWidth_m + 2.0));
  for (double s = random.uniform(0.0, 300.0); s < way.length_m(); s += random.uniform(350.0, 500.0)) {
    builder.stand(gantry, way.at(s).p_world, way.at(s).heading_rad);
  }
  line_with(builder, street,
            {.meshes = plants.trees,
             .offset_m = kHalfWidth_m + 12.0,
             .spacing_m = 14.0,
             .density = 0.3,
             .keep_free = true});
  line_with(builder, street,
            {.meshes = plants.bushes,
             .offset_m = kHalfWidth_m + 6.0,
             .spacing_m = 6.0,
             .density = 0.3,
             .keep_free = true});
  line_with(builder, street,
            {.meshes = plants.trees,
             .offset_m = kHalfWidth_m + 30.0,
             .spacing_m = 9.0,
             .density = 0.6,
             .keep_free = true});

  const Lane own{
      .path = way.offset(-kSlowLane_m), .spacing_m = 42.0, .speed_mps = kSpeed_mps, .truck_share = 0.4};
  add_robot_lane(builder,
                 {.lane = own, .s_start_m = kLeadIn_m, .length_m = options.length_m, .ahead = 4, .behind = 3},
                 catalogue);
  const Path back = way.reversed();
  add_traffic(builder,
              {.path = way.offset(-kFastLane_m), .spacing_m = 34.0, .speed_mps = 28.0, .truck_share = 0.0},
              catalogue);
  add_traffic(builder,
              {.path = back.offset(-kFastLane_m), .spacing_m = 55.0, .speed_mps = 31.0, .truck_share = 0.0},
              catalogue);
  add_traffic(builder,
              {.path = back.offset(-kSlowLane_m), .spacing_m = 50.0, .speed_mps = 24.0, .truck_share = 0.4},
              catalogue);
  return builder.finish(way.part(kLeadIn_m - 60.0, kLeadIn_m + options.length_m + 60.0), 0.05);
}

}  // namespace mlo::simulator
