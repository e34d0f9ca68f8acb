#pragma once

#include <vector>

#include "mlo/simulator/scene_builder.hpp"
#include "mlo/simulator/structures.hpp"
#include "mlo/simulator/traffic.hpp"

namespace mlo::simulator {

/// A road that a scene has added to its site.
struct Street {
  Path centerline;
  std::size_t road = 0;  ///< its number on the site
  double half_width_m = 0.0;
  double sidewalk_m = 0.0;
};

Street add_street(SceneBuilder& builder, const Path& centerline, double half_width_m, double sidewalk_m);

/// What lines a street, and how densely.
struct Frontage {
  double setback_m = 0.5;  ///< between sidewalk and facade
  double vacancy = 0.12;   ///< share of lots without a building
  double min_width_m = 10.0, max_width_m = 18.0;
  double min_depth_m = 9.0, max_depth_m = 13.0;
  int min_storeys = 2, max_storeys = 5;
  double gap_m = 0.0;  ///< between neighbours
  double roof_rise_m = 0.0;
};
/// Buildings on both sides, facing the street.
void line_with_buildings(SceneBuilder& builder, const Street& street, const Frontage& frontage);

/// A building across each end of the street: what one looks at down a street.
void close_with_buildings(SceneBuilder& builder, const Street& street, const Frontage& frontage);

/// Meshes at regular places beside the street, where the ground is not another road.
struct Row {
  std::vector<std::size_t> meshes;  ///< one is picked for each place
  double offset_m = 0.0;            ///< from the centre line, on both sides
  double spacing_m = 10.0;
  double density = 1.0;    ///< share of the places that are used
  bool keep_free = false;  ///< refuse places that are taken by buildings and the like
  bool random_yaw = true;  ///< otherwise x along the street, y towards it
};
void line_with(SceneBuilder& builder, const Street& street, const Row& row);

/// Cars parked along both kerbs.
void park_along(SceneBuilder& builder, const Street& street, const ModelCatalogue& catalogue,
                double occupancy);

/// People on both sidewalks: most walk, some stand.
void add_walkers(SceneBuilder& builder, const Street& street, const ModelCatalogue& catalogue,
                 double spacing_m);
/// People who cross the street.
void add_crossers(SceneBuilder& builder, const Street& street, const ModelCatalogue& catalogue, int count);

/// Cyclists along both sides of a way, offset_m from its middle.
void add_cyclists(SceneBuilder& builder, const Path& way, const ModelCatalogue& catalogue, double offset_m,
                  double spacing_m = 60.0);

/// One lane of traffic.
struct Lane {
  Path path;
  double spacing_m = 35.0;  ///< between vehicles, on average
  double speed_mps = 9.0;
  double speed_spread_mps = 1.0;
  double truck_share = 0.05;
  std::vector<RedLight> lights = {};
};
void add_traffic(SceneBuilder& builder, const Lane& lane, const ModelCatalogue& catalogue);

/// The robot's own lane: it drives among others.
struct RobotDrive {
  Lane lane;
  double s_start_m = 0.0;
  double length_m = 300.0;  ///< the drive ends after this way
  int ahead = 2;            ///< vehicles in front of it
  int behind = 1;
};
/// Sets the builder's robot and adds the vehicles of its lane.
void add_robot_lane(SceneBuilder& builder, const RobotDrive& drive, const ModelCatalogue& catalogue);

/// A gently rolling ground: waves of random direction.
Terrain rolling_terrain(Random random, double amplitude_m, double wavelength_m);

}  // namespace mlo::simulator
