#include <numbers>
#include <vector>

#include "mlo/simulator/scene.hpp"
#include "mlo/simulator/street.hpp"

namespace mlo::simulator {
namespace {

constexpr double kHalfWidth_m = 3.6;
constexpr double kLane_m = 1.75;
constexpr double kTrack_m = 6.6;     // of the track's middle, left of the road's
constexpr double kBallast_m = 0.55;  // top of the track bed above the ground
constexpr double kLeadIn_m = 80.0;
constexpr double kRobot_mps = 10.0;
constexpr double kTrain_mps = 18.0;
constexpr int kCarriages = 12;
constexpr double kStopShare = 0.45;  // of the way: there the robot waits at a red light
constexpr double kWait_s = 11.0;
constexpr double kCarriage_m = 25.0;
constexpr double kCoupling_m = 0.6;

void add_track(SceneBuilder& builder, const Path& track) {
  const Terrain& terrain = builder.scene.terrain;
  builder.place_world(extrude(
      terrain, track, {{2.9, -0.3}, {2.0, kBallast_m - 0.15}, {-2.0, kBallast_m - 0.15}, {-2.9, -0.3}},
      {Surface::rail, Surface::rail, Surface::rail}, 3.0));
  for (const double side : {-0.75, 0.75}) {
    builder.place_world(extrude(terrain, track,
                                {{side - 0.04, kBallast_m - 0.15},
                                 {side - 0.04, kBallast_m},
                                 {side + 0.04, kBallast_m},
                                 {side + 0.04, kBallast_m - 0.15}},
                                {Surface::rail, Surface::rail, Surface::rail}, 3.0));
  }
  const std::size_t mast = builder.add_mesh(tube({0, 0, -0.5}, {0, 0, 7.5}, 0.14, 0.12, Surface::pole));
  for (double s = 10.0; s < track.length_m(); s += 55.0) {
    builder.stand(mast, track.offset(3.3).at(s).p_world, 0.0);
  }
}

/// When the robot comes to its stop, about: braking costs it some seconds.
double arrival_s(double length_m) {
  return kStopShare * length_m / kRobot_mps + 2.0;
}

/// The train overtakes the driving robot on its way to the light, and goes on passing while it stands and
/// when it starts again.
void add_carriages(SceneBuilder& builder, const Path& track, double length_m) {
  const std::size_t carriage = builder.add_model(make_carriage(kCarriage_m));
  const double meeting_s = 0.4 * arrival_s(length_m);
  const double robot_m = kLeadIn_m + kRobot_mps * meeting_s;
  const double head_m = robot_m - kTrain_mps * meeting_s - 0.5 * kCarriage_m;  // middle of the first one
  for (int i = 0; i < kCarriages; ++i) {
    const Motion motion =
        cruise(track, head_m - i * (kCarriage_m + kCoupling_m), kTrain_mps, builder.scene.duration_s);
    builder.add_object(carriage, motion, kBallast_m, false);
  }
}

/// A suburb's street along the railway: houses on both sides, those on the left beyond the track.
void furnish(SceneBuilder& builder, const Street& street, const PlantCatalogue& plants) {
  line_with_buildings(builder, street,
                      {.setback_m = 14.0,
                       .vacancy = 0.6,
                       .min_width_m = 9.0,
                       .max_width_m = 15.0,
                       .min_storeys = 1,
                       .max_storeys = 3,
                       .gap_m = 7.0,
                       .roof_rise_m = 3.0});
  line_with(builder, street,
            {.meshes = {builder.add_mesh(make_lamp(7.0))},
             .offset_m = kHalfWidth_m + 0.8,
             .spacing_m = 32.0,
             .keep_free = true,
             .random_yaw = false});
  line_with(builder, street,
            {.meshes = {builder.add_mesh(make_sign())},
             .offset_m = kHalfWidth_m + 0.6,
             .spacing_m = 45.0,
             .density = 0.5,
             .random_yaw = false});
  line_with(builder, street,
            {.meshes = plants.hedges,
             .offset_m = kHalfWidth_m + 2.6,
             .spacing_m = PlantCatalogue::kHedgeLength_m,
             .density = 0.12,
             .keep_free = true,
             .random_yaw = false});
  line_with(builder, street,
            {.meshes = plants.trees,
             .offset_m = kHalfWidth_m + 5.0,
             .spacing_m = 15.0,
             .density = 0.35,
             .keep_free = true});
  line_with(builder, street,
            {.meshes = plants.bushes,
             .offset_m = kHalfWidth_m + 6.5,
             .spacing_m = 7.0,
             .density = 0.25,
             .keep_free = true});
  line_with(builder, street,
            {.meshes = plants.trees,
             .offset_m = kHalfWidth_m + 28.0,
             .spacing_m = 10.0,
             .density = 0.5,
             .keep_free = true});
}

}  // namespace

Scene make_train(const SceneOptions& options) {
  SceneBuilder builder("train", options.seed, rolling_terrain(Random(options.seed), 1.0, 260.0));
  Random& random = builder.random;
  const ModelCatalogue catalogue = add_catalogue(builder);
  const PlantCatalogue plants = add_plants(builder);
  const double total = options.length_m + 2.0 * kLeadIn_m;
  const Path way(
      PathPoint{},
      {{0.5 * total, random.uniform(-1.0, 1.0) / 900.0}, {0.5 * total, random.uniform(-1.0, 1.0) / 900.0}},
      60.0);
  const Street street = add_street(builder, way, kHalfWidth_m, 0.0);
  const Path track = way.offset(kTrack_m);
  builder.site.add_road(track, 4.0);  // nothing else stands there
  add_track(builder, track);

  furnish(builder, street, plants);

  constexpr double kAlways_s = 1e4;
  const RedLight light{.s_m = kLeadIn_m + kStopShare * options.length_m + 5.0,
                       .period_s = kAlways_s,
                       .red_s = arrival_s(options.length_m) + kWait_s};
  const Lane own{.path = way.offset(-kLane_m), .spacing_m = 50.0, .speed_mps = kRobot_mps, .lights = {light}};
  add_robot_lane(builder,
                 {.lane = own, .s_start_m = kLeadIn_m, .length_m = options.length_m, .ahead = 1, .behind = 1},
                 catalogue);
  add_carriages(builder, track, options.length_m);
  add_traffic(builder, {.path = way.reversed().offset(-kLane_m), .spacing_m = 120.0, .speed_mps = 13.0},
              catalogue);
  return builder.finish(way, 0.06);
}

}  // namespace mlo::simulator
