#pragma once

#include "mlo/core/fields.hpp"

namespace mlo {

/// How far off a detector's boxes are. Every standard deviation shrinks with confidence: it is
/// sd * exp(-decay * logit(confidence)), the logit cut to [-2, 12]. Measured on PointRCNN's cars against
/// KITTI's labels (docs/tracking.md); score tells more than range.
struct BoxNoiseConfig {
  double along_m = 0.40;
  double along_decay = 0.125;
  double across_m = 0.33;
  double across_decay = 0.18;
  double height_m = 0.17;
  double height_decay = 0.12;
  double yaw_deg = 12.0;
  double yaw_decay = 0.20;
  double size_m = 0.40;
  double size_decay = 0.07;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("along_m", along_m, between(0.01, 10.0), "of the centre along the heading at confidence 0.5 [m]");
    visit("along_decay", along_decay, between(0.0, 1.0), "its decay with the logit of the confidence");
    visit("across_m", across_m, between(0.01, 10.0), "of the centre across the heading [m]");
    visit("across_decay", across_decay, between(0.0, 1.0), "its decay");
    visit("height_m", height_m, between(0.01, 10.0), "of the height of the centre [m]");
    visit("height_decay", height_decay, between(0.0, 1.0), "its decay");
    visit("yaw_deg", yaw_deg, between(0.1, 90.0), "of the heading, flips apart [deg]");
    visit("yaw_decay", yaw_decay, between(0.0, 1.0), "its decay");
    visit("size_m", size_m, between(0.01, 10.0), "of the length; width and height have 0.4 of it [m]");
    visit("size_decay", size_decay, between(0.0, 1.0), "its decay");
  }
};

/// How objects move: either they stand, or their velocity changes by random accelerations.
struct ObjectMotionConfig {
  double standing_noise_m = 0.05;
  double acceleration_mps2 = 2.5;
  double start_speed_mps = 6.0;
  double sideways_speed_mps = 0.4;
  double switch_probability = 0.03;
  double turn_noise_degps2 = 40.0;
  double velocity_sd_mps = 0.5;
  double height_noise_m = 0.10;
  double size_noise_m = 0.02;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("standing_noise_m", standing_noise_m, between(0.0, 10.0),
          "drift of a standing object in one second, which is that of the ego poses; larger forgets "
          "faster [m]");
    visit("acceleration_mps2", acceleration_mps2, between(0.01, 100.0),
          "random acceleration of moving objects; larger follows faster and averages less [m/s^2]");
    visit("start_speed_mps", start_speed_mps, between(0.1, 100.0),
          "speeds to expect of a new object, standard deviation [m/s]");
    visit("sideways_speed_mps", sideways_speed_mps, between(0.01, 100.0),
          "speed of wheeled objects across their heading, standard deviation [m/s]");
    visit("switch_probability", switch_probability, between(1e-6, 0.5),
          "chance to start or to stop within one scan");
    visit("turn_noise_degps2", turn_noise_degps2, between(0.1, 1000.0),
          "random angular acceleration [deg/s^2]");
    visit("velocity_sd_mps", velocity_sd_mps, between(0.0, 100.0),
          "of velocities from points, added to what the estimate says of itself [m/s]");
    visit("height_noise_m", height_noise_m, between(0.0, 10.0),
          "change of the height above the plane in one second [m]");
    visit("size_noise_m", size_noise_m, between(0.0, 10.0),
          "change of the size in one second: sizes settle, yet follow when more of an object is seen [m]");
  }
};

/// Which detection continues which track.
struct AssociationConfig {
  double gate = 20.0;
  double partial_view = 0.046;
  double size_weight = 1.0;
  double heading_weight = 1.0;
  double high_confidence_logit = 2.0;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("gate", gate, between(0.1, 1000.0),
          "largest squared distance over its variance; larger keeps more identities, and swaps more");
    visit("partial_view", partial_view, between(0.0, 1.0),
          "standard deviation added to positions, in lengths of the object: boxes of partly seen "
          "objects are further off than their noise says");
    visit("size_weight", size_weight, between(0.0, 100.0), "of the difference of sizes over its variance");
    visit("heading_weight", heading_weight, between(0.0, 100.0),
          "of the difference of headings (flips apart) over its variance");
    visit("high_confidence_logit", high_confidence_logit, between(-20.0, 20.0),
          "detections above are given out first, to all tracks; those below continue tracks that were left");
  }
};

/// When a track begins and ends. Its existence is a log-odds: detections add to it, misses take
/// from it.
struct LifecycleConfig {
  double evidence_zero_logit = 2.0;
  double far_evidence_zero_logit = -1.5;
  double near_range_m = 40.0;
  double blind_range_m = 62.0;
  double field_of_view_deg = 360.0;
  double evidence_per_logit = 0.3;
  double max_evidence = 1.15;
  double miss_visible = 1.35;
  double miss_hidden = 0.2;
  double max_existence = 4.0;
  double drop_existence = -1.0;
  int max_coasting = 60;
  int max_tentative_misses = 2;
  double min_birth_logit = -2.0;
  double max_overlap = 0.14;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("evidence_zero_logit", evidence_zero_logit, between(-20.0, 20.0),
          "logit of the confidence at which a detection says as much for as against an object");
    visit("far_evidence_zero_logit", far_evidence_zero_logit, between(-20.0, 20.0),
          "the same at the range where the detector sees nothing any more: far objects have low scores");
    visit("near_range_m", near_range_m, between(0.0, 1000.0),
          "up to here a detector sees what is in plain view [m]");
    visit("blind_range_m", blind_range_m, between(0.0, 1000.0), "from here a miss says nothing [m]");
    visit("field_of_view_deg", field_of_view_deg, between(1.0, 360.0),
          "sector ahead in which the detector finds objects; outside, and partly outside, a miss says "
          "nothing [deg]");
    visit("evidence_per_logit", evidence_per_logit, between(0.0, 10.0),
          "log-odds for each logit above; below 1 because false alarms repeat themselves");
    visit("max_evidence", max_evidence, between(0.0, 20.0), "most log-odds from one detection, either way");
    visit("miss_visible", miss_visible, between(0.0, 20.0), "log-odds taken by a miss in plain view");
    visit("miss_hidden", miss_hidden, between(0.0, 20.0), "log-odds taken by a miss behind another object");
    visit("max_existence", max_existence, between(0.0, 100.0),
          "most log-odds; larger reports long-lived tracks for longer after they were last seen");
    visit("drop_existence", drop_existence, between(-50.0, 20.0), "log-odds below which a track ends");
    visit("max_coasting", max_coasting, between(0, 1000),
          "scans in a row that a confirmed track is predicted without detection; the paper has 2");
    visit("max_tentative_misses", max_tentative_misses, between(0, 1000),
          "the same for one that was never confirmed");
    visit("min_birth_logit", min_birth_logit, between(-20.0, 20.0),
          "least logit of the confidence to begin a track with");
    visit("max_overlap", max_overlap, between(0.0, 1.0),
          "objects do not stand in each other: of two that share more of their ground area, the one "
          "without detection ends; the less believed one, if they are of different kinds");
  }
};

/// Weights of what speaks for and against showing a track (report_belief.hpp): a logistic regression, fitted
/// to KITTI's labels (docs/tracking.md).
struct BeliefWeights {
  double bias = -7.1;
  double per_existence = 0.45;
  double per_best_logit = 0.48;
  double per_logit = 0.40;
  double far = 5.0;
  double per_margin_deg = 0.64;
  double per_sd_m = -0.68;
  double per_wider_m = 0.0;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("bias", bias, between(-50.0, 50.0),
          "belief when all that follows is zero; lower has fewer false alarms and more misses");
    visit("per_existence", per_existence, between(0.0, 50.0), "for each log-odds of existence");
    visit("per_best_logit", per_best_logit, between(0.0, 50.0),
          "for each logit of the most confident detection in the track's life");
    visit("per_logit", per_logit, between(0.0, 50.0),
          "for each logit of this scan's detection; a predicted track has none");
    visit("far", far, between(0.0, 50.0),
          "at the range where the detector sees nothing any more: far objects have low confidence");
    visit(
        "per_margin_deg", per_margin_deg, between(0.0, 50.0),
        "for each degree, up to 4 either way, from the border of the field of view, where boxes are cut off");
    visit("per_sd_m", per_sd_m, between(-50.0, 0.0),
          "for each metre of standard deviation, up to 3, of a predicted track's position");
    visit("per_wider_m", per_wider_m, between(-50.0, 0.0),
          "for each metre of width above that of usual cars: what is wider is a truck, a tram or a hedge");
  }
};

/// What is shown: tracks whose belief, the log-odds that the box is that of an object, is not negative.
struct ReportConfig {
  BeliefWeights vehicle{.per_wider_m = -13.3};
  BeliefWeights pedestrian{.bias = -7.0,
                           .per_existence = 1.3,
                           .per_best_logit = 0.37,
                           .per_logit = 0.08,
                           .far = 0.7,
                           .per_margin_deg = 1.0};
  BeliefWeights cyclist{
      .bias = -5.6, .per_existence = 0.37, .far = 1.0, .per_margin_deg = 0.2, .per_sd_m = -1.0};

  template <class Visitor>
  void fields(Visitor& visit) {
    visit.group("vehicle", vehicle, "Cars and all that is not named below.");
    visit.group("pedestrian", pedestrian, "Pedestrians.");
    visit.group("cyclist", cyclist, "Cyclists.");
  }
};

/// What the relative motion of an object is estimated from.
enum class SgfMode {
  fusion,    ///< points and boxes
  semantic,  ///< boxes only
  geometry   ///< points only
};

/// Estimate of each object's motion from its points and its box (paper, section III-C-2, Eq. (5)-(13)).
struct SgfConfig {
  SgfMode mode = SgfMode::fusion;
  bool centred = true;
  bool printed_weights = false;
  double kernel = 3.0;
  double effective_points = 10.0;
  double voxel_m = 0.3;
  int min_points = 10;
  int max_iterations = 12;
  double converged_m = 1e-3;
  int target_scans = 5;
  double standing_gain = 0.1;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("mode", mode,
          Choices<SgfMode>{
              {"fusion", SgfMode::fusion}, {"semantic", SgfMode::semantic}, {"geometry", SgfMode::geometry}},
          "fusion: points and boxes; semantic: boxes only; geometry: points only");
    visit("centred", centred, Anything{},
          "planes of boxes about their centre; false: about the lidar, as printed in Eq. (8), where a "
          "yaw error grows with the range");
    visit("printed_weights", printed_weights, Anything{},
          "weights of Eq. (13) as printed; false: both terms in units of their variances");
    visit("kernel", kernel, between(0.0, 100.0),
          "residual, in standard deviations, beyond which it loses weight; 0: none, as printed");
    visit("effective_points", effective_points, between(1.0, 10000.0),
          "independent points that all of an object's points are worth; more trust points over boxes");
    visit("voxel_m", voxel_m, between(0.05, 5.0), "side of the voxels that points are matched to [m]");
    visit("min_points", min_points, between(3, 1000), "matched points that an estimate without box needs");
    visit("max_iterations", max_iterations, between(1, 100), "of Levenberg-Marquardt");
    visit("converged_m", converged_m, between(1e-6, 1.0), "step that ends the iterations [m], and in rad");
    visit("target_scans", target_scans, between(1, 100),
          "earlier scans whose points are the target, in the object's own frame; 1 is the paper's");
    visit("standing_gain", standing_gain, between(0.0, 1.0),
          "part of the estimated motion that counts for an object that stands; smaller averages longer, 1 "
          "(the paper's) accumulates all of it");
  }
};

/// Multi-object tracking (paper, section III-C-2).
struct TrackingConfig {
  SgfConfig sgf;
  BoxNoiseConfig box_noise;
  ObjectMotionConfig motion;
  AssociationConfig association;
  LifecycleConfig lifecycle;
  ReportConfig report;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit.group("sgf", sgf, "Motion of each object from its points and its box.");
    visit.group("box_noise", box_noise, "How far off a detector's boxes are.");
    visit.group("motion", motion, "How objects move.");
    visit.group("association", association, "Which detection continues which track.");
    visit.group("lifecycle", lifecycle, "When a track begins and ends.");
    visit.group("report", report, "Which tracks are shown.");
  }
};

}  // namespace mlo
