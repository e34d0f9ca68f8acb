#pragma once

#include "mlo/core/fields.hpp"

namespace mlo {

/// Ground segmentation, ground.hpp.
struct GroundConfig {
  int sectors = 36;
  double zone_depth_m = 3.0;
  double zone_growth = 0.3;
  int min_zone_points = 12;
  int iterations = 3;
  double seed_height_m = 0.3;
  double max_distance_m = 0.2;
  double max_roughness_m = 0.07;
  double max_slope_deg = 20.0;
  double max_bend_deg = 6.0;
  double max_step_m = 0.3;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("sectors", sectors, between(4, 180),
          "azimuth sectors walked independently; more follow a cross slope better, each with fewer points");
    visit("zone_depth_m", zone_depth_m, between(0.5, 20.0),
          "depth of the nearest zones of a sector [m]; deeper zones hold more scan lines but bend less");
    visit("zone_growth", zone_growth, between(0.0, 1.0),
          "depth of a far zone over its range, as scan lines spread with range; 0 keeps all zones alike");
    visit("min_zone_points", min_zone_points, between(3, 1000),
          "with fewer points near the expected ground a zone keeps the plane of the one before it");
    visit("iterations", iterations, between(1, 10), "rounds of fitting a plane and choosing its points anew");
    visit("seed_height_m", seed_height_m, between(0.01, 2.0),
          "points up to here above the lowest begin the fit [m]; more bridges kerbs, less keeps cars out");
    visit(
        "max_distance_m", max_distance_m, between(0.01, 1.0),
        "ground lies this near to its plane [m]; more takes in kerbs and verges, less spares feet of walls");
    visit("max_roughness_m", max_roughness_m, between(0.005, 1.0),
          "most that ground points deviate from their plane, RMS [m]; more takes grass and climbs on hedges");
    visit("max_slope_deg", max_slope_deg, between(1.0, 60.0),
          "steepest ground, against the ground around the sensor [deg]; steeper planes are walls and bushes");
    visit(
        "max_bend_deg", max_bend_deg, between(0.5, 45.0),
        "most that the ground turns from one zone to the next, and rises or falls where it is hidden [deg]");
    visit("max_step_m", max_step_m, between(0.01, 2.0),
          "most that the ground rises or falls at once from one zone to the next [m]");
  }
};

/// Scan lines and the choice of features on them, scan_lines.hpp and features.hpp.
struct FeatureConfig {
  int segments_per_line = 6;
  int ground_per_segment = 4;
  int edges_per_segment = 4;
  int edge_candidates_per_segment = 20;
  int surfaces_per_segment = 5;
  double min_edge_smoothness = 0.03;
  double max_surface_smoothness = 0.005;
  double candidate_voxel_m = 0.2;
  double no_line_voxel_m = 2.0;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("segments_per_line", segments_per_line, between(1, 64),
          "equal parts of a scan line that choose their features each for itself; more spread them wider");
    visit("ground_per_segment", ground_per_segment, between(0, 100),
          "flattest ground points taken per segment; more match better and cost time");
    visit("edges_per_segment", edges_per_segment, between(0, 100),
          "sharpest background points taken per segment; more admit weaker edges");
    visit("edge_candidates_per_segment", edge_candidates_per_segment, between(0, 1000),
          "sharpest background points per segment that later edges are matched against");
    visit("surfaces_per_segment", surfaces_per_segment, between(0, 100),
          "flattest background points taken per segment; more match better and cost time");
    visit("min_edge_smoothness", min_edge_smoothness, between(0.0, 10.0),
          "an edge is at least this sharp (c of LOAM); higher keeps poles and jumps of depth only, "
          "lower takes the noise of smooth walls for edges, which hides that a tunnel is degenerate");
    visit("max_surface_smoothness", max_surface_smoothness, between(0.0, 10.0),
          "a surface feature is at most this rough (c of LOAM); lower keeps smooth walls only");
    visit("candidate_voxel_m", candidate_voxel_m, between(0.01, 5.0),
          "one ground and one surface candidate per voxel of this side [m]; smaller is finer and slower");
    visit("no_line_voxel_m", no_line_voxel_m, between(0.1, 20.0),
          "scans without rings: one ground and one surface feature per voxel of this side [m]; smaller "
          "matches more and costs time");
  }
};

/// Mutual correction of ground and objects, fusion.hpp.
struct FusionConfig {
  double box_margin_m = 0.1;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("box_margin_m", box_margin_m, between(0.0, 2.0),
          "boxes count as this much larger on every side [m]; more keeps objects out of the background "
          "when boxes are too tight, less loses fewer background points");
  }
};

/// All of perception (paper, section III-B).
struct PerceptionConfig {
  GroundConfig ground;
  FeatureConfig features;
  FusionConfig fusion;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit.group("ground", ground, "Which points lie on the ground.");
    visit.group("features", features, "Choice of ground, edge and surface features on the scan lines.");
    visit.group("fusion", fusion, "What detected boxes take from the ground and the background.");
  }
};

}  // namespace mlo
