#pragma once

#include <algorithm>

#include "mlo/core/box.hpp"
#include "mlo/tracking/config.hpp"

namespace mlo {

/// What speaks for and against showing a track after a scan.
struct BeliefCues {
  double existence = 0.0;      ///< log-odds (lifecycle.hpp)
  double best_logit = 0.0;     ///< of the confidence of its surest detection so far
  double logit = 0.0;          ///< of that of this scan's detection; 0 without
  double detectability = 1.0;  ///< at its range (lifecycle.hpp)
  double margin_deg = 180.0;   ///< from the border of the field of view; negative: partly outside
  double sd_m = 0.0;           ///< of a predicted position; 0 with detection
  double wider_m = 0.0;        ///< than usual for its class
};

/// Log-odds that a track's box is that of an object.
constexpr double report_belief(const BeliefCues& cues, const BeliefWeights& weights) {
  constexpr double kMaxMargin_deg = 4.0;
  constexpr double kMaxSd_m = 3.0;
  return weights.bias + weights.per_existence * cues.existence + weights.per_best_logit * cues.best_logit +
         weights.per_logit * cues.logit + weights.far * (1.0 - cues.detectability) +
         weights.per_margin_deg * std::clamp(cues.margin_deg, -kMaxMargin_deg, kMaxMargin_deg) +
         weights.per_sd_m * std::min(cues.sd_m, kMaxSd_m) + weights.per_wider_m * cues.wider_m;
}

constexpr const BeliefWeights& weights_for(ObjectClass object_class, const ReportConfig& config) {
  if (object_class == ObjectClass::pedestrian) return config.pedestrian;
  return object_class == ObjectClass::cyclist ? config.cyclist : config.vehicle;
}

/// How much wider than usual (the mean width of KITTI's cars) a box is that is said to be a car; 0 for other
/// classes. [m]
constexpr double excess_width_m(ObjectClass object_class, double width_m) {
  constexpr double kCarWidth_m = 1.63;
  return object_class == ObjectClass::car ? width_m - kCarWidth_m : 0.0;
}

}  // namespace mlo
