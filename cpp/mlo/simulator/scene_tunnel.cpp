#include <algorithm>
#include <numbers>
#include <vector>

#include "mlo/simulator/scene.hpp"
#include "mlo/simulator/street.hpp"

namespace mlo::simulator {
namespace {

constexpr double kHalfWidth_m = 4.5;
constexpr double kWall_m = 5.4;    // of the bore, from the middle
constexpr double kSmooth_m = 3.0;  // road goes on behind the walls: no rough ground inside
constexpr double kLane_m = 2.0;
constexpr double kLeadIn_m = 60.0;
constexpr double kApproach_m = 40.0;  // shortest way in the open before the tunnel
constexpr double kSpeed_mps = 14.0;

/// Cross-section of the bore, from the foot of the left wall over the vault to the foot of the right one.
std::vector<Eigen::Vector2d> bore() {
  constexpr double kSpring_m = 3.4;  // where the vault begins
  std::vector<Eigen::Vector2d> profile{{kWall_m, -0.2}};
  constexpr int kFacets = 10;
  for (int i = 0; i <= kFacets; ++i) {
    const double angle = std::numbers::pi * i / kFacets;
    profile.emplace_back(kWall_m * std::cos(angle), kSpring_m + 3.2 * std::sin(angle));
  }
  profile.emplace_back(-kWall_m, -0.2);
  return profile;
}

/// The wall around the mouth of the tunnel.
Mesh portal(const Terrain& terrain, const PathPoint& at) {
  constexpr double kHalf_m = 16.0;
  constexpr double kTop_m = 9.0;
  const double z = terrain.height(at.p_world);
  const auto on = [&](double left, double up) {
    const Eigen::Vector2d p = at.p_world + left * at.left();
    return Eigen::Vector3d(p.x(), p.y(), z + up);
  };
  Mesh mesh =
      quad(on(-kHalf_m, -2.0), on(-kWall_m, -2.0), on(-kWall_m, kTop_m), on(-kHalf_m, kTop_m), Surface::wall);
  mesh += quad(on(kWall_m, -2.0), on(kHalf_m, -2.0), on(kHalf_m, kTop_m), on(kWall_m, kTop_m), Surface::wall);
  mesh += quad(on(-kWall_m, 6.8), on(kWall_m, 6.8), on(kWall_m, kTop_m), on(-kWall_m, kTop_m), Surface::wall);
  return mesh;
}

void furnish_outside(SceneBuilder& builder, const Path& outside, const PlantCatalogue& plants,
                     std::size_t lamp) {
  const Street street = add_street(builder, outside, kHalfWidth_m, 0.0);
  line_with(builder, street,
            {.meshes = plants.trees,
             .offset_m = kHalfWidth_m + 5.0,
             .spacing_m = 7.0,
             .density = 0.5,
             .keep_free = true});
  line_with(builder, street,
            {.meshes = plants.bushes,
             .offset_m = kHalfWidth_m + 2.5,
             .spacing_m = 4.0,
             .density = 0.5,
             .keep_free = true});
  line_with(builder, street,
            {.meshes = plants.trees,
             .offset_m = kHalfWidth_m + 14.0,
             .spacing_m = 7.0,
             .density = 0.7,
             .keep_free = true});
  line_with(builder, street,
            {.meshes = {lamp}, .offset_m = kHalfWidth_m + 1.0, .spacing_m = 25.0, .random_yaw = false});
}

}  // namespace

Scene make_tunnel(const SceneOptions& options) {
  SceneBuilder builder("tunnel", options.seed, Terrain{});
  const ModelCatalogue catalogue = add_catalogue(builder);
  const PlantCatalogue plants = add_plants(builder);
  const double total = options.length_m + 2.0 * kLeadIn_m + 120.0;
  const Path way = straight({0.0, 0.0}, 0.3, total);
  const double mouth = kLeadIn_m + std::max(kApproach_m, 0.15 * options.length_m);
  const double exit = std::max(mouth + 60.0, kLeadIn_m + 0.9 * options.length_m);

  const std::size_t lamp = builder.add_mesh(make_lamp(8.0));
  furnish_outside(builder, way.part(0.0, mouth - 3.0), plants, lamp);
  furnish_outside(builder, way.part(exit + 3.0, total), plants, lamp);
  builder.site.add_road(way.part(mouth - kSmooth_m, exit + kSmooth_m), kWall_m + kSmooth_m);
  const std::vector<Eigen::Vector2d> profile = bore();
  builder.place_world(extrude(builder.scene.terrain, way.part(mouth, exit), profile,
                              std::vector<Surface>(profile.size() - 1, Surface::wall), 5.0));
  builder.place_world(portal(builder.scene.terrain, way.at(mouth)));
  builder.place_world(portal(builder.scene.terrain, way.at(exit)));

  const Lane own{.path = way.offset(-kLane_m), .spacing_m = 45.0, .speed_mps = kSpeed_mps};
  add_robot_lane(builder,
                 {.lane = own, .s_start_m = kLeadIn_m, .length_m = options.length_m, .ahead = 2, .behind = 1},
                 catalogue);
  add_traffic(builder, {.path = way.reversed().offset(-kLane_m), .spacing_m = 70.0, .speed_mps = kSpeed_mps},
              catalogue);
  return builder.finish(way.part(0.0, total), 0.03);
}

}  // namespace mlo::simulator
