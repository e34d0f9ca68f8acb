#pragma once

#include "mlo/core/fields.hpp"

namespace mlo {

/// The map around the robot against which scans are registered.
struct LocalMapConfig {
  double voxel_m = 0.5;
  int max_points_per_voxel = 20;
  double min_spacing_m = 0.1;
  double radius_m = 100.0;
  bool separate_classes = false;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("voxel_m", voxel_m, between(0.05, 10.0),
          "edge of a voxel: neighbours are found up to this far; larger is slower [m]");
    visit("max_points_per_voxel", max_points_per_voxel, between(1, 20),
          "bounds memory and search time; fewer points describe surfaces less well");
    visit("min_spacing_m", min_spacing_m, between(0.0, 5.0),
          "a point nearer than this to one of its voxel is not added: even density against detail [m]");
    visit("radius_m", radius_m, between(10.0, 1000.0),
          "what is farther from the robot is forgotten: memory against returning points of view [m]");
    visit("separate_classes", separate_classes, Anything{},
          "ground, edges and surfaces in maps of their own, as in the paper, or all in one");
  }
};

/// What a neighbourhood of map points is taken for when a point is matched to it.
enum class ShapeModel {
  loam,         ///< planes for ground and surface points, lines for edge points; nothing else matches
  distribution  ///< planes where it is flat, else its distribution
};

/// Scan-to-map registration, section III-D-2.
struct RefinementConfig {
  ShapeModel shape_model = ShapeModel::distribution;
  bool correct_distortion = true;
  double source_voxel_m = 0.6;
  int neighbours = 8;
  double max_thickness_m = 0.1;
  double max_flatness = 0.1;
  double noise_m = 0.07;
  double gate_m = 0.8;
  double gate_without_motion_m = 3.0;
  double final_gate_m = 0.3;
  double gate_shrink = 0.6;
  double kernel_m = 0.2;
  double rematch_distance_m = 0.03;
  int coarse_stride = 8;
  int max_iterations = 15;
  int max_iterations_without_motion = 40;
  double translation_tolerance_m = 1e-3;
  double rotation_tolerance_rad = 2e-5;
  int min_matches = 100;
  double min_curvature = 1e-3;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("shape_model", shape_model,
          Choices<ShapeModel>{{"loam", ShapeModel::loam}, {"distribution", ShapeModel::distribution}},
          "loam: lines for edges, planes for the rest, as in the paper; distribution: planes where it "
          "is flat, elsewhere whitened by the spread of the neighbours");
    visit("correct_distortion", correct_distortion, Anything{},
          "true: distortion follows the pose while it is refined; false: it is removed once, with "
          "odometry's increment, as in the paper");
    visit("source_voxel_m", source_voxel_m, between(0.05, 10.0),
          "the scan is thinned to one point per voxel, the ground apart from the rest: accuracy against time "
          "[m]");
    visit("neighbours", neighbours, between(5, 8), "map points that make a neighbourhood");
    visit("max_thickness_m", max_thickness_m, between(0.001, 10.0),
          "a neighbourhood thicker than this (standard deviation) is no plane [m]");
    visit("max_flatness", max_flatness, between(0.0, 1.0),
          "smallest over middle variance above which a neighbourhood is no plane");
    visit("noise_m", noise_m, between(0.001, 1.0),
          "standard deviation of a point: how much a wide neighbourhood counts less than a flat one [m]");
    visit("gate_m", gate_m, between(0.01, 50.0), "distance to the nearest map point at the first match [m]");
    visit("gate_without_motion_m", gate_without_motion_m, between(0.01, 50.0),
          "the same while the speed is not known: the first scans, and after a failure [m]");
    visit("final_gate_m", final_gate_m, between(0.01, 50.0), "the gate shrinks to this [m]");
    visit("gate_shrink", gate_shrink, between(0.1, 1.0), "factor by which the gate shrinks per iteration");
    visit("kernel_m", kernel_m, between(0.001, 10.0),
          "scale of the Geman-McClure kernel: smaller trusts outliers less and converges slower [m]");
    visit("rematch_distance_m", rematch_distance_m, between(0.0, 1.0),
          "neighbours are searched again when a point has moved more than this [m]");
    visit("coarse_stride", coarse_stride, between(1, 100),
          "the first iterations use every n-th point only, until the motion is nearly found");
    visit("max_iterations", max_iterations, between(1, 200), "Gauss-Newton iterations");
    visit("max_iterations_without_motion", max_iterations_without_motion, between(1, 500),
          "the same while the speed is not known");
    visit("translation_tolerance_m", translation_tolerance_m, between(0.0, 1.0),
          "a smaller step ends the iterations [m]");
    visit("rotation_tolerance_rad", rotation_tolerance_rad, between(0.0, 1.0),
          "a smaller step ends the iterations [rad]");
    visit("min_matches", min_matches, between(6, 100000), "with fewer the estimate is not used");
    visit("min_curvature", min_curvature, between(0.0, 1.0),
          "directions that a mean match constrains less than this are degenerate and left to the prediction");
  }
};

/// What scans tell about places that their rays go through.
struct FreeSpaceConfig {
  int every = 3;
  double range_m = 80.0;
  double margin_m = 0.2;
  double margin_per_range = 0.005;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit(
        "every", every, between(0, 1000),
        "every n-th scan tells what is free: the map loses what moved, detected or not; 0: none does, as in "
        "the paper");
    visit("range_m", range_m, between(1.0, 500.0),
          "how far from the robot this is done: completeness against time [m]");
    visit("margin_m", margin_m, between(0.0, 10.0),
          "a ray that ends this much beyond a point went through it: lower removes more, of what stands "
          "too [m]");
    visit("margin_per_range", margin_per_range, between(0.0, 1.0),
          "added to the margin for each metre of range");
  }
};

/// Things that move and that no detector reports.
struct UnknownMoversConfig {
  int every = 8;
  int scans_remembered = 20;
  int min_free = 2;
  double column_m = 0.5;
  double min_share = 0.5;
  int min_points = 6;
  double min_way_m = 1.0;
  int min_scans = 5;
  double came_for_s = 2.0;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("every", every, between(0, 1000),
          "every n-th scan is remembered; 0: nothing is looked for, as in the paper");
    visit("scans_remembered", scans_remembered, between(1, 1000),
          "more find longer and slower things, at more time and memory");
    visit("min_free", min_free, between(1, 1000),
          "a point is new where so many of these went through its place before any ended there");
    visit("column_m", column_m, between(0.1, 5.0),
          "points are judged together in upright columns of this width [m]");
    visit("min_share", min_share, between(0.0, 1.0),
          "a column is new when this share of its points is of those that can be told");
    visit("min_points", min_points, between(1, 100000),
          "new columns side by side are one thing if they hold so many points");
    visit("min_way_m", min_way_m, between(0.0, 100.0),
          "it is reported while it moves on this far in a second, and straight [m]");
    visit("min_scans", min_scans, between(2, 1000), "and was seen in so many scans in a row");
    visit("came_for_s", came_for_s, between(0.0, 10.0),
          "what stands where it came along within this time moves too, as the rest of a train does [s]");
  }
};

/// The long-term map that is saved.
struct StaticMapConfig {
  double voxel_m = 0.2;
  int turns = 2;
  double hit_votes = 0.8;
  double max_votes = 8.0;
  double sure_votes = 3.0;
  double moving_margin_m = 0.5;
  double trail_s = 1.2;
  double memory_radius_m = 200.0;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("voxel_m", voxel_m, between(0.01, 10.0),
          "one point per voxel is kept: detail against memory and file size [m]");
    visit("turns", turns, between(1, 1000),
          "of the points at places that the local map has already, one in so many is looked up in each scan, "
          "in "
          "turn: lower misses less, higher is faster");
    visit("hit_votes", hit_votes, between(0.0, 100.0),
          "a ray that ends at a point votes this much for it, one that went through one vote against it, and "
          "points with votes below zero are left out: higher keeps more of what is thin");
    visit("max_votes", max_votes, between(1.0, 1000.0),
          "no more votes are kept for or against a point: lower follows changes sooner");
    visit("sure_votes", sure_votes, between(0.0, 1000.0),
          "points with fewer votes are left out where their surroundings were seen through: higher "
          "removes more, of what stands too");
    visit("moving_margin_m", moving_margin_m, between(0.0, 5.0),
          "boxes of tracks that move count as this much larger on every side, so that nothing of them "
          "is added [m]");
    visit("trail_s", trail_s, between(0.0, 10.0),
          "and so they do where such a track is expected to have been this long before it was found to move, "
          "and to be this long after it was lost [s]");
    visit("memory_radius_m", memory_radius_m, between(50.0, 1e6),
          "what is farther from the robot waits on disk: memory against reading it again on return [m]");
  }
};

/// Weights of what tells that an object at rest has begun to move (motion_belief.hpp): a logistic regression,
/// fitted to the truth of simulated car parks (docs/results.md).
struct MotionWeights {
  double bias = -5.2;
  double per_speed_logit = 1.45;
  double per_significance = 0.55;
  double per_m = -8.8;
  double per_fit_gain = 14.0;
  double per_map_misfit = 4.6;
  double per_map_gain = 4.2;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("bias", bias, between(-50.0, 50.0),
          "belief when all that follows is zero; lower finds starts later, and fewer that are none");
    visit("per_speed_logit", per_speed_logit, between(0.0, 50.0),
          "for each log-odds that it moves, by its speed");
    visit("per_significance", per_significance, between(0.0, 50.0),
          "for each standard deviation, up to 12, that its points lie from where they were");
    visit("per_m", per_m, between(-50.0, 0.0),
          "for each metre, up to 0.5, of this displacement: what rested a scan before cannot be far");
    visit("per_fit_gain", per_fit_gain, between(0.0, 100.0),
          "for the share of its points that lie on its map only when the displacement is undone");
    visit("per_map_misfit", per_map_misfit, between(0.0, 50.0),
          "for the mean distance, 0 to 1, of the map's points from what is seen now");
    visit("per_map_gain", per_map_gain, between(0.0, 50.0),
          "for the share of it that the displacement explains: new sides of an object explain none");
  }
};

/// Which objects move, section III-D-1.
struct DynamicCheckConfig {
  bool static_objects_localise = false;
  double start_probability = 0.6;
  double moving_probability = 0.5;
  MotionWeights start;
  double min_displacement_m = 0.04;
  double min_significance = 4.0;
  double in_place_m = 0.25;
  int min_sightings = 5;
  double same_place_m = 1.0;
  int scans_in_place = 2;
  double still_m = 0.1;
  int scans_still = 3;
  int min_points = 10;
  double map_spacing_m = 0.1;
  double gate_m = 0.5;
  double kernel_m = 0.15;
  double point_sd_m = 0.03;
  double prior_shift_sd_m = 0.5;
  double prior_turn_sd_rad = 0.02;
  int iterations = 6;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("static_objects_localise", static_objects_localise, Anything{},
          "points of objects at rest take part in the map refinement, as in the paper; off is its MLO-ddo");
    visit("start_probability", start_probability, between(0.0, 1.0),
          "by its speed, where too few points tell, an object at rest moves from here on: lower finds slow "
          "ones "
          "sooner, and noise");
    visit.group("start", start, "What tells by its points and its speed that an object at rest moves.");
    visit("moving_probability", moving_probability, between(0.0, 1.0),
          "and one that moves does so as long as it is above this");
    visit("min_displacement_m", min_displacement_m, between(0.0, 10.0),
          "or its points lie this far from where they were [m]");
    visit("min_significance", min_significance, between(0.0, 100.0), "and this many standard deviations");
    visit("in_place_m", in_place_m, between(0.0, 10.0),
          "points tell of a stop as long as the object is this near to where its motion was last seen [m]");
    visit("min_sightings", min_sightings, between(1, 1000),
          "the map of an object at rest counts from so many scans on");
    visit("same_place_m", same_place_m, between(0.0, 10.0),
          "a detection this near to an object at rest is taken for it before tracking says so [m]");
    visit("scans_in_place", scans_in_place, between(1, 1000),
          "where points can tell, an object that moves is at rest again after so many scans in a row without "
          "speed or displacement");
    visit("still_m", still_m, between(0.0, 10.0),
          "or, whatever its speed seems, with its points surely within this of where they were [m]");
    visit("scans_still", scans_still, between(1, 1000), "in so many scans");
    visit("min_points", min_points, between(3, 10000), "with fewer only the speed counts");
    visit("map_spacing_m", map_spacing_m, between(0.01, 1.0),
          "between points in the map of an object: detail against memory [m]");
    visit("gate_m", gate_m, between(0.05, 10.0),
          "points farther from the map are new parts of the object [m]");
    visit("kernel_m", kernel_m, between(0.001, 10.0),
          "scale of the Geman-McClure kernel: smaller trusts outliers less [m]");
    visit("point_sd_m", point_sd_m, between(0.001, 1.0),
          "standard deviation of a point, at least: larger believes in motion later [m]");
    visit("prior_shift_sd_m", prior_shift_sd_m, between(0.01, 100.0),
          "motion that is expected of an object at rest: smaller bears surfaces that slide along themselves "
          "[m]");
    visit("prior_turn_sd_rad", prior_turn_sd_rad, between(0.001, 10.0), "the same for its turning [rad]");
    visit("iterations", iterations, between(1, 100), "Gauss-Newton iterations");
  }
};

/// The search for the first pose in the map of an earlier run.
struct PlaceSearchConfig {
  double radius_m = 5.0;
  double yaw_deg = 15.0;
  double step_m = 0.75;
  double yaw_step_deg = 2.5;
  double min_share = 0.4;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("radius_m", radius_m, between(0.0, 100.0),
          "how far from the given start is looked: reach against time [m]");
    visit("yaw_deg", yaw_deg, between(0.0, 180.0), "how far to both sides of its heading [deg]");
    visit("step_m", step_m, between(0.1, 10.0), "between the starts that are tried [m]");
    visit("yaw_step_deg", yaw_step_deg, between(0.1, 90.0), "between their headings [deg]");
    visit("min_share", min_share, between(0.0, 1.0),
          "part of the scan that has to lie on the map: higher asks for a map without changes");
  }
};

struct MappingConfig {
  LocalMapConfig local_map;
  RefinementConfig refinement;
  FreeSpaceConfig free_space;
  UnknownMoversConfig unknown_movers;
  StaticMapConfig static_map;
  DynamicCheckConfig dynamic_check;
  PlaceSearchConfig place_search;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit.group("local_map", local_map, "The map around the robot that scans are registered to.");
    visit.group("refinement", refinement, "Scan-to-map registration (paper, section III-D-2).");
    visit.group("free_space", free_space, "What scans tell about places that their rays go through.");
    visit.group("unknown_movers", unknown_movers, "Things that move and that no detector reports.");
    visit.group("static_map", static_map, "The long-term map that is saved.");
    visit.group("dynamic_check", dynamic_check, "Which objects move (paper, section III-D-1).");
    visit.group("place_search", place_search, "The first pose in the map of an earlier run (run --map).");
  }
};

}  // namespace mlo
