#include <numbers>
#include <vector>

#include "mlo/simulator/scene.hpp"
#include "mlo/simulator/street.hpp"

namespace mlo::simulator {
namespace {

constexpr double kHalfWidth_m = 3.6;
constexpr double kLane_m = 1.75;
constexpr double kTrack_m = 8.5;     // of the track's middle, left of the road's
constexpr double kBallast_m = 0.55;  // top of the track bed above the ground
constexpr double kLeadIn_m = 80.0;
constexpr double kRobot_mps = 10.0;
constexpr double kTrain_mps = 14.0;
constexpr int kCarriages = 9;
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

void add_carriages(SceneBuilder& builder, const Path& track) {
  const std::size_t carriage = builder.add_model(make_carriage(kCarriage_m));
  const double head =
      kLeadIn_m + 45.0;  // of the first carriage's middle: the train passes while the robot drives
  for (int i = 0; i < kCarriages; ++i) {
    const Motion motion =
        cruise(track, head - i * (kCarriage_m + kCoupling_m), kTrain_mps, builder.scene.duration_s);
    builder.add_object(carriage, motion, kBallast_m, false);
  }
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

  line_with(builder, street,
            {.meshes = {builder.add_mesh(make_sign())},
             .offset_m = kHalfWidth_m + 0.6,
             .spacing_m = 60.0,
             .density = 0.4,
             .random_yaw = false});
  line_with(builder, street,
            {.meshes = plants.trees,
             .offset_m = kHalfWidth_m + 3.0,
             .spacing_m = 18.0,
             .density = 0.35,
             .keep_free = true});
  line_with(builder, street,
            {.meshes = plants.bushes,
             .offset_m = kHalfWidth_m + 14.0,
             .spacing_m = 8.0,
             .density = 0.4,
             .keep_free = true});
  line_with(builder, street,
            {.meshes = plants.trees,
             .offset_m = kHalfWidth_m + 28.0,
             .spacing_m = 10.0,
             .density = 0.4,
             .keep_free = true});
  line_with_buildings(builder, street,
                      {.setback_m = 16.0,
                       .vacancy = 0.75,
                       .min_storeys = 1,
                       .max_storeys = 2,
                       .gap_m = 12.0,
                       .roof_rise_m = 3.0});

  const Lane own{.path = way.offset(-kLane_m), .spacing_m = 50.0, .speed_mps = kRobot_mps};
  add_robot_lane(builder,
                 {.lane = own, .s_start_m = kLeadIn_m, .length_m = options.length_m, .ahead = 1, .behind = 1},
                 catalogue);
  add_carriages(builder, track);
  add_traffic(builder, {.path = way.reversed().offset(-kLane_m), .spacing_m = 120.0, .speed_mps = 13.0},
              catalogue);
  return builder.finish(way, 0.06);
}

}  // namespace mlo::simulator
