#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mlo/simulator/scene.hpp"
#include "mlo/simulator/street.hpp"

namespace mlo::simulator {
namespace {

using Eigen::Vector2d;

constexpr double kPi = std::numbers::pi;
constexpr double kAisle_m = 60.0;  // length
constexpr double kPitch_m = 16.4;  // from one aisle to the next
constexpr double kStallDepth_m = 5.0;
constexpr double kStallWidth_m = 2.7;
constexpr double kStall_m = 0.5 * kPitch_m - 0.5 * kStallDepth_m;  // of a stall's middle, from the aisle's
constexpr double kApron_m = 12.0;  // free ground at the ends of the aisles, for turning
constexpr double kSpeed_mps = 3.0;

struct Stall {
  Vector2d p_world;
  double yaw_rad;  ///< of a car that drove in head first
  double aisle_y;
};

/// Up one aisle and down the next.
Path serpentine(int aisles) {
  const double radius = 0.5 * kPitch_m;
  std::vector<PathPiece> pieces;
  for (int i = 0; i < aisles; ++i) {
    pieces.push_back({kAisle_m, 0.0});
    pieces.push_back({kPi * radius, (i % 2 == 0 ? 1.0 : -1.0) / radius});
  }
  pieces.push_back({kAisle_m, 0.0});
  return Path(PathPoint{}, pieces, 3.0);
}

std::vector<Stall> stalls_of(int aisles) {
  std::vector<Stall> stalls;
  for (int i = 0; i < aisles; ++i) {
    const double y = i * kPitch_m;
    for (const double side : {-1.0, 1.0}) {
      for (double x = 3.0; x < kAisle_m - 3.0; x += kStallWidth_m) {
        stalls.push_back({{x, y + side * kStall_m}, side * 0.5 * kPi, y});
      }
    }
  }
  return stalls;
}

/// Backs out of the stall around a quarter turn, waits, and drives off along the aisle.
Motion leave(const Stall& stall, double wait_s, bool to_the_east) {
  constexpr double kRadius_m = 4.6;
  const double out_heading = stall.yaw_rad + kPi;
  // the car ends up facing the way it will drive, so it backs towards the other side
  const double back_heading = to_the_east ? kPi : 0.0;
  const double turn = std::remainder(back_heading - out_heading, 2.0 * kPi);
  const double straight_m = kStall_m - kRadius_m;
  const Path back({.p_world = stall.p_world, .heading_rad = out_heading},
                  {{straight_m, 0.0}, {0.5 * kPi * kRadius_m, (turn > 0.0 ? 1.0 : -1.0) / kRadius_m}}, 0.5);
  const Motion backing = glide(back, 1.2, wait_s, true);
  const PlanarState turned = backing.states().back();
  const double to_end =
      to_the_east ? kAisle_m + 0.5 * kApron_m - turned.p_world.x() : turned.p_world.x() + 0.5 * kApron_m;
  return backing.then(
      glide(straight(turned.p_world, turned.yaw_rad, std::max(2.0, to_end)), kSpeed_mps, 1.5));
}

void fill(SceneBuilder& builder, const std::vector<Stall>& stalls, const ModelCatalogue& catalogue) {
  Random& random = builder.random;
  for (const Stall& stall : stalls) {
    if (random.chance(0.22)) continue;
    const std::size_t model =
        random.chance(0.1) ? pick(random, catalogue.vans) : pick(random, catalogue.cars);
    const bool leaves = random.chance(0.08);
    const double wait = random.uniform(0.0, builder.scene.duration_s);
    const bool east = random.chance(0.5);
    if (leaves && builder.add_object(model, leave(stall, wait, east))) continue;
    const double yaw = stall.yaw_rad + (random.chance(0.25) ? kPi : 0.0) + random.uniform(-0.04, 0.04);
    builder.park(model, stall.p_world + Vector2d(random.uniform(-0.1, 0.1), random.uniform(-0.2, 0.2)), yaw);
  }
}

void add_people(SceneBuilder& builder, int aisles, const ModelCatalogue& catalogue) {
  Random& random = builder.random;
  for (int i = 0; i < 4 * aisles; ++i) {
    const double y = random.integer(0, aisles - 1) * kPitch_m + (random.chance(0.5) ? 2.3 : -2.3);
    const Path way = straight({random.uniform(0.0, kAisle_m), y}, random.chance(0.5) ? 0.0 : kPi, kAisle_m);
    const Motion motion = glide(way, random.uniform(0.9, 1.5), random.uniform(0.0, builder.scene.duration_s));
    builder.add_object(pick(random, catalogue.pedestrians), motion);
  }
}

void surround(SceneBuilder& builder, int aisles) {
  Random& random = builder.random;
  const PlantCatalogue plants = add_plants(builder);
  const double top = (aisles - 0.5) * kPitch_m;
  const double bottom = -0.5 * kPitch_m;
  // the shop
  BuildingShape shop{.width_m = 46.0,
                     .depth_m = 20.0,
                     .storey_m = 5.5,
                     .storeys = 1,
                     .window_width_m = 3.0,
                     .window_gap_m = 2.0};
  builder.stand(builder.add_mesh(make_building(shop)), {0.5 * kAisle_m, bottom - 18.0}, 0.0);
  const auto edge = [&](double y, double spacing, double density, const std::vector<std::size_t>& meshes,
                        bool turn) {
    for (double x = -kApron_m; x < kAisle_m + kApron_m; x += spacing) {
      const std::size_t mesh = pick(random, meshes);
      if (random.chance(density)) builder.stand(mesh, {x, y}, turn ? random.uniform(0.0, 2.0 * kPi) : 0.0);
    }
  };
  edge(top + 1.5, PlantCatalogue::kHedgeLength_m, 0.85, plants.hedges, false);
  edge(top + 5.0, 8.0, 0.7, plants.trees, true);
  edge(top + 14.0, 7.0, 0.6, plants.trees, true);
  edge(bottom - 3.0, 9.0, 0.5, plants.trees, true);
  const std::size_t lamp = builder.add_mesh(make_lamp(6.5));
  for (int i = 0; i <= aisles; ++i) {
    for (const double x : {0.0, 0.5 * kAisle_m, kAisle_m})
      builder.stand(lamp, {x, (i - 0.5) * kPitch_m}, 0.0);
  }
  for (const double x : {-kApron_m - 3.0, kAisle_m + kApron_m + 3.0}) {
    for (double y = bottom; y < top; y += 6.0) {
      const std::size_t mesh = random.chance(0.5) ? pick(random, plants.trees) : pick(random, plants.bushes);
      builder.stand(mesh, {x, y}, random.uniform(0.0, 2.0 * kPi));
    }
  }
}

}  // namespace

Scene make_parking(const SceneOptions& options) {
  SceneBuilder builder("parking", options.seed, rolling_terrain(Random(options.seed), 0.3, 90.0));
  const ModelCatalogue catalogue = add_catalogue(builder);
  const double per_aisle = kAisle_m + 0.5 * kPi * kPitch_m;
  const int aisles = std::max(3, static_cast<int>(std::ceil(options.length_m / per_aisle)) + 1);
  const Path way = serpentine(aisles - 1);
  for (int i = 0; i < aisles; ++i) {
    const Path aisle = straight({-kApron_m, i * kPitch_m}, 0.0, kAisle_m + 2.0 * kApron_m);
    builder.site.add_road(aisle, 0.5 * kPitch_m);
  }
  surround(builder, aisles);
  add_robot_lane(builder,
                 {.lane = {.path = way, .speed_mps = kSpeed_mps, .speed_spread_mps = 0.0},
                  .s_start_m = 2.0,
                  .length_m = options.length_m,
                  .ahead = 0,
                  .behind = 0},
                 catalogue);
  fill(builder, stalls_of(aisles), catalogue);
  add_people(builder, aisles, catalogue);
  return builder.finish(way, 0.03);
}

}  // namespace mlo::simulator
