#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mlo/core/fields.hpp"

namespace mlo {

/// The geometric consistency check (paper, Algorithm 1). Shares are of the features that are counted.
struct ConsistencyConfig {
  double min_share = 0.5;             ///< th_r
  double min_ground_share = 0.3;      ///< th_g
  double min_background_share = 0.3;  ///< th_b
  double min_gain = 0.05;
  int iterations = 20;     ///< N_iter
  int match_interval = 5;  ///< lambda
  int sample_size = 3;
  int max_counted = 150;
  double max_distance_m = 0.2;
  double max_distance_per_range = 0.005;
  double ground_max_distance_m = 1.0;
  std::uint64_t seed = 1;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("min_share", min_share, between(0.0, 1.0),
          "th_r: a set passes with at least this share of all features; higher refuses scenes that "
          "mostly move");
    visit("min_ground_share", min_ground_share, between(0.0, 1.0),
          "th_g: the same of the ground features; higher refuses motions that leave the ground");
    visit(
        "min_background_share", min_background_share, between(0.0, 1.0),
        "th_b: the same of edge and surface features; higher refuses motions that only the ground supports");
    visit("min_gain", min_gain, between(0.0, 1.0),
          "a motion replaces the best so far, at first the prediction, with this much more share; "
          "higher holds on to the prediction when as much moves as stands; 0 is the paper's");
    visit("iterations", iterations, between(1, 1000),
          "N_iter: motions that are tried; more find the static part of a scene with more movers, at "
          "more time");
    visit("match_interval", match_interval, between(1, 1000),
          "lambda: matches are renewed at the best motion every so many iterations");
    visit("sample_size", sample_size, between(2, 1000),
          "matches of the ground, and of the background, drawn for each motion; fewer are more often "
          "free of movers, more average noise better");
    visit("max_counted", max_counted, between(10, 100000),
          "features of each kind that are counted for a motion; more judge better, at more time");
    visit(
        "max_distance_m", max_distance_m, between(0.01, 10.0),
        "a feature agrees when a candidate is this near [m]; smaller sees slower movers, larger bears noise");
    visit("max_distance_per_range", max_distance_per_range, between(0.0, 0.2),
          "added to the distances for each metre of range, where points are sparse");
    visit("ground_max_distance_m", ground_max_distance_m, between(0.01, 10.0),
          "the same distance on the ground, where scan lines are far apart [m]");
    visit("seed", seed, Anything{}, "of the random samples; the frame number is added");
  }
};

/// Scan-to-scan ego odometry (paper, section III-C-1).
struct OdometryConfig {
  /// two_step: [t_z, roll, pitch] from the ground, then [t_x, t_y, yaw] from the background; joint: all at
  /// once.
  enum class Estimator { two_step, joint };

  bool enabled = true;
  Estimator estimator = Estimator::two_step;
  bool consistency_check = true;
  ConsistencyConfig consistency;
  int max_features = 600;
  int max_candidates = 5000;
  double gate_m = 1.0;
  double patch_radius_m = 3.0;
  double min_baseline_m = 0.25;
  int max_ring_gap = 5;
  double kernel_m = 0.08;
  int max_matchings = 8;
  int steps_per_matching = 3;
  double rematch_distance_m = 0.01;
  double rematch_angle_deg = 0.02;
  int min_matches = 20;
  double min_curvature = 0.005;
  double lever_arm_m = 10.0;
  double start_radius_m = 2.5;
  double start_step_m = 0.5;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("enabled", enabled, Anything{},
          "off: the map refinement starts from constant motion alone; faster, less robust");
    visit("estimator", estimator,
          Choices<Estimator>{{"two_step", Estimator::two_step}, {"joint", Estimator::joint}},
          "two_step: height, roll and pitch from the ground, then the rest from the background, as the "
          "paper; joint: all six at once");
    visit("consistency_check", consistency_check, Anything{},
          "remove features that move against the rest before estimating; off is the paper's MLO-gc");
    visit.group("consistency", consistency, "Geometric consistency check (Algorithm 1).");
    visit("max_features", max_features, between(10, 100000),
          "features of each kind that are used, evenly thinned; more are more accurate and slower");
    visit("max_candidates", max_candidates, between(10, 1000000),
          "points of each kind to match against, evenly thinned; more are more accurate and slower");
    visit("gate_m", gate_m, between(0.05, 20.0),
          "farthest nearest point of a match [m]; wider bears worse predictions, and more wrong matches");
    visit("patch_radius_m", patch_radius_m, between(0.1, 20.0),
          "the points of a line or plane lie this near the feature [m]; larger finds more, and fits worse");
    visit(
        "min_baseline_m", min_baseline_m, between(0.0, 5.0),
        "the points of a line or plane lie this far apart [m]; larger directions are less noisy, and rarer");
    visit("max_ring_gap", max_ring_gap, between(1, 16),
          "scan lines between the points of a line or plane; more bridge missing scan lines, at more time");
    visit("kernel_m", kernel_m, between(0.001, 10.0),
          "residual at which a match counts half [m]; smaller trusts outliers less and converges slower");
    visit("max_matchings", max_matchings, between(1, 100), "matchings for an estimate; more cost time");
    visit("steps_per_matching", steps_per_matching, between(1, 100),
          "Gauss-Newton steps between matchings at most");
    visit("rematch_distance_m", rematch_distance_m, between(0.0, 1.0),
          "a motion that moved less since the last matching is final [m]; smaller is more exact and slower");
    visit("rematch_angle_deg", rematch_angle_deg, between(0.0, 5.0), "the same for its rotation [deg]");
    visit("min_matches", min_matches, between(3, 100000),
          "with fewer matches nothing is estimated; more refuses poor scenes instead of guessing");
    visit("min_curvature", min_curvature, between(0.0, 1.0),
          "mean squared sensitivity below which a direction counts as degenerate and keeps its prediction");
    visit("lever_arm_m", lever_arm_m, between(0.1, 100.0),
          "distance at which rotations are compared with translations [m]");
    visit("start_radius_m", start_radius_m, between(0.0, 20.0),
          "motions that are searched where nothing predicts one, as at the first scans [m]");
    visit("start_step_m", start_step_m, between(0.05, 5.0), "step of this search [m]; finer costs time");
  }

  /// What contradicts itself, one sentence each.
  std::vector<std::string> find_problems() const {
    std::vector<std::string> problems;
    if (min_baseline_m >= patch_radius_m)
      problems.emplace_back("min_baseline_m must be smaller than patch_radius_m");
    return problems;
  }
};

}  // namespace mlo
