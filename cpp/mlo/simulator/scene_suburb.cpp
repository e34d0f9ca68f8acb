#include <algorithm>
#include <numbers>
#include <vector>

#include "mlo/simulator/scene.hpp"
#include "mlo/simulator/street.hpp"

namespace mlo::simulator {
namespace {

constexpr double kHalfWidth_m = 4.7;
constexpr double kSidewalk_m = 1.6;
constexpr double kLane_m = 1.75;
constexpr double kTurnRadius_m = 12.0;
constexpr double kShortestLoop_m = 240.0;

/// A rectangle with round corners, driven counter-clockwise from the middle of one side; it closes by
/// symmetry.
std::vector<PathPiece> loop_pieces(double circumference_m) {
  const double arc = 0.5 * std::numbers::pi * kTurnRadius_m;
  const double sides = 0.5 * (circumference_m - 4.0 * arc);  // of one long and one short side
  const double a = 0.6 * sides;
  const double b = 0.4 * sides;
  const PathPiece turn{arc, 1.0 / kTurnRadius_m};
  return {{0.5 * a, 0.0}, turn, {b, 0.0}, turn, {a, 0.0}, turn, {b, 0.0}, turn, {0.5 * a, 0.0}};
}

void park_in_driveways(SceneBuilder& builder, const Street& street, const ModelCatalogue& catalogue) {
  Random& random = builder.random;
  for (const double side : {-1.0, 1.0}) {
    for (double s = random.uniform(0.0, 15.0); s < street.centerline.length_m();
         s += random.uniform(12.0, 26.0)) {
      const PathPoint point = street.centerline.at(s);
      const double offset = side * (kHalfWidth_m + kSidewalk_m + random.uniform(3.2, 4.5));
      const Eigen::Vector2d p = point.p_world + offset * point.left();
      const std::size_t model = pick(random, catalogue.cars);
      const double yaw = point.heading_rad + (random.chance(0.5) ? 0.5 : -0.5) * std::numbers::pi;
      const Footprint place{p, yaw, 5.0, 2.2};
      if (!builder.site.is_free(place)) continue;
      if (builder.park(model, p, yaw)) builder.site.take(place);
    }
  }
}

void furnish(SceneBuilder& builder, const Street& street, const PlantCatalogue& plants, std::size_t lamp,
             std::size_t sign) {
  const double edge = kHalfWidth_m + kSidewalk_m;
  line_with_buildings(builder, street,
                      {.setback_m = 6.0,
                       .vacancy = 0.12,
                       .min_width_m = 8.0,
                       .max_width_m = 13.0,
                       .min_depth_m = 8.0,
                       .max_depth_m = 10.5,
                       .min_storeys = 1,
                       .max_storeys = 2,
                       .gap_m = 5.0,
                       .roof_rise_m = 2.6});
  line_with(builder, street,
            {.meshes = plants.hedges,
             .offset_m = edge + 0.7,
             .spacing_m = PlantCatalogue::kHedgeLength_m,
             .density = 0.6,
             .random_yaw = false});
  line_with(
      builder, street,
      {.meshes = plants.trees, .offset_m = edge + 3.5, .spacing_m = 9.0, .density = 0.45, .keep_free = true});
  line_with(
      builder, street,
      {.meshes = plants.bushes, .offset_m = edge + 2.2, .spacing_m = 5.0, .density = 0.4, .keep_free = true});
  line_with(
      builder, street,
      {.meshes = plants.trees, .offset_m = edge + 21.0, .spacing_m = 8.0, .density = 0.6, .keep_free = true});
  line_with(builder, street,
            {.meshes = {lamp}, .offset_m = kHalfWidth_m + 0.4, .spacing_m = 35.0, .random_yaw = false});
  line_with(builder, street,
            {.meshes = {sign},
             .offset_m = kHalfWidth_m + 0.4,
             .spacing_m = 45.0,
             .density = 0.5,
             .random_yaw = false});
}

}  // namespace

Scene make_suburb(const SceneOptions& options) {
  constexpr double kHills_m = 2.2;
  constexpr double kSideStreet_m = 70.0;
  SceneBuilder builder("suburb", options.seed, rolling_terrain(Random(options.seed), kHills_m, 170.0));
  Random& random = builder.random;
  const ModelCatalogue catalogue = add_catalogue(builder);
  const PlantCatalogue plants = add_plants(builder);

  // the lane is inside the loop's middle line on a left turn: the loop is made longer so that the lane has
  // the length
  const double circumference = std::max(options.length_m, kShortestLoop_m) - 2.0 * std::numbers::pi * kLane_m;
  const std::vector<PathPiece> pieces = loop_pieces(circumference);
  std::vector<PathPiece> laps = pieces;
  laps.insert(laps.end(), pieces.begin(), pieces.end());
  const Path loop(PathPoint{}, pieces, 7.0);
  const Path way(PathPoint{}, laps, 7.0);

  std::vector<Street> streets{add_street(builder, loop, kHalfWidth_m, kSidewalk_m)};
  for (const double share : {0.25, 0.5, 0.75}) {  // side streets leave the loop to the right
    const PathPoint point = loop.at(share * loop.length_m() + random.uniform(-8.0, 8.0));
    const Path side = straight(point.p_world, point.heading_rad - 0.5 * std::numbers::pi, kSideStreet_m);
    streets.push_back(add_street(builder, side, kHalfWidth_m, kSidewalk_m));
  }
  const std::size_t lamp = builder.add_mesh(make_lamp(5.5));
  const std::size_t sign = builder.add_mesh(make_sign());
  for (const Street& street : streets) furnish(builder, street, plants, lamp, sign);

  const Lane own{.path = way.offset(-kLane_m), .spacing_m = 45.0, .speed_mps = 8.0};
  add_robot_lane(builder,
                 {.lane = own, .s_start_m = 0.0, .length_m = options.length_m, .ahead = 1, .behind = 1},
                 catalogue);
  add_traffic(builder, {.path = way.reversed().offset(-kLane_m), .spacing_m = 90.0, .speed_mps = 8.0},
              catalogue);
  for (const Street& street : streets) {
    park_along(builder, street, catalogue, 0.25);
    park_in_driveways(builder, street, catalogue);
    add_crossers(builder, street, catalogue, 1);
    add_walkers(builder, street, catalogue, 35.0);
  }
  add_cyclists(builder, loop, catalogue, kHalfWidth_m - 1.2, 90.0);
  return builder.finish(loop, 0.04);
}

}  // namespace mlo::simulator
