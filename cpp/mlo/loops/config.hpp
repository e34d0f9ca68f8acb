#pragma once

#include "mlo/core/fields.hpp"

namespace mlo {

/// Closing loops at the end of a run.
struct LoopClosureConfig {
  bool enabled = false;
  double keyframe_m = 2.0;
  double min_way_m = 50.0;
  double drift = 0.05;
  double max_difference = 0.35;
  double min_share = 0.5;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("enabled", enabled, Anything{},
          "true: places that are seen again correct the way in between, once the run is over");
    visit("keyframe_m", keyframe_m, between(0.1, 100.0),
          "way between the scans that are compared: detail against time [m]");
    visit("min_way_m", min_way_m, between(1.0, 10000.0),
          "way between two visits of a place: shorter loops are left to the local map [m]");
    visit("drift", drift, between(0.0, 1.0),
          "how far off the estimated pose may be after a way, as a part of it: reach against wrong places");
    visit("max_difference", max_difference, between(0.0, 1.0),
          "between the descriptors of the same place, 0 for equal ones");
    visit("min_share", min_share, between(0.0, 1.0),
          "part of a scan that has to lie on what was mapped before: higher refuses more");
  }
};

}  // namespace mlo
