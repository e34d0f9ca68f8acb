#pragma once

#include <vector>

#include "mlo/simulator/mesh.hpp"

namespace mlo::simulator {

/// Measures of a building; its frame: middle of the footprint, on the ground, x along its width.
struct BuildingShape {
  double width_m = 12.0;  ///< along x: the street
  double depth_m = 12.0;  ///< along y
  double storey_m = 3.1;
  int storeys = 4;
  double window_width_m = 1.2;
  double window_gap_m = 1.3;
  double roof_rise_m = 0.0;  ///< gable along x; 0: flat
  bool balconies = false;
};

Mesh make_building(const BuildingShape& shape);

/// Trees stand on their trunk's foot.
Mesh make_tree(double height_m, double crown_radius_m, Random random);
Mesh make_bush(double radius_m, double height_m, Random random);
/// A stretch of hedge along x, centred.
Mesh make_hedge(double length_m, double thickness_m, double height_m, Random random);
/// Street lamp with its arm along +y.
Mesh make_lamp(double height_m);
/// Traffic sign facing -x.
Mesh make_sign();
Mesh make_traffic_light();
/// Gantry across a road, span along y.
Mesh make_gantry(double span_m);
Mesh make_bin();
/// Pitch of fence along x, centred.
Mesh make_fence(double length_m, double height_m);

}  // namespace mlo::simulator
