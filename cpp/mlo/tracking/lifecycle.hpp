#pragma once

#include <algorithm>
#include <string_view>

#include "mlo/tracking/config.hpp"

namespace mlo {

/// Life of a track.
enum class TrackState {
  tentative,  ///< seen, not yet believed
  confirmed,  ///< believed, and detected in this scan
  coasting,   ///< believed, predicted in this scan
  dead
};

constexpr std::string_view to_string(TrackState state) {
  switch (state) {
    case TrackState::tentative:
      return "tentative";
    case TrackState::confirmed:
      return "confirmed";
    case TrackState::coasting:
      return "coasting";
    case TrackState::dead:
      break;
  }
  return "dead";
}

/// What is known of a track's existence after a scan.
struct TrackEvidence {
  double existence = 0.0;  ///< log-odds
  bool believed = false;   ///< enough to be reported (report_belief.hpp)
  int misses = 0;          ///< scans in a row without a detection; 0: detected in this one
};

/// The state that follows, given the evidence with this scan's outcome already in it.
constexpr TrackState next_state(TrackState state, const TrackEvidence& evidence,
                                const LifecycleConfig& config) {
  if (state == TrackState::dead || evidence.existence < config.drop_existence) return TrackState::dead;
  if (state == TrackState::tentative) {
    if (evidence.misses > config.max_tentative_misses) return TrackState::dead;
    return evidence.believed && evidence.misses == 0 ? TrackState::confirmed : TrackState::tentative;
  }
  if (evidence.misses == 0) return TrackState::confirmed;
  return evidence.misses > config.max_coasting ? TrackState::dead : TrackState::coasting;
}

/// How surely the detector finds an object in plain view at this range, 1 near to 0 far.
constexpr double detectability(double range_m, const LifecycleConfig& config) {
  if (range_m <= config.near_range_m) return 1.0;
  if (range_m >= config.blind_range_m) return 0.0;
  return (config.blind_range_m - range_m) / (config.blind_range_m - config.near_range_m);
}

/// Log-odds that a detection adds to a track's existence.
constexpr double detection_evidence(double confidence_logit, double range_m, const LifecycleConfig& config) {
  const double far = 1.0 - detectability(range_m, config);
  const double zero =
      config.evidence_zero_logit + far * (config.far_evidence_zero_logit - config.evidence_zero_logit);
  const double evidence = config.evidence_per_logit * (confidence_logit - zero);
  return std::clamp(evidence, -config.max_evidence, config.max_evidence);
}

/// Log-odds that a miss takes.
/// @param visible  chance that the detector would have found the object if it were there, in [0, 1]
constexpr double miss_evidence(double visible, const LifecycleConfig& config) {
  return -(config.miss_hidden + visible * (config.miss_visible - config.miss_hidden));
}

}  // namespace mlo
