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
  double wider_m = 0.0;        ///< than usual, of a car; 0 for other classes
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

/// Usual width of a detector's cars: the mean over those that it saw surely. Widths that no car has are left
/// out.
class UsualCarWidth {
 public:
  constexpr void add(double width_m) {
    if (!(width_m > 1.0 && width_m < 3.0)) return;
    sum_m_ += width_m;
    ++count_;
  }
  /// How much wider a car is; 0 as long as too few were seen to tell.
  constexpr double excess_m(double width_m) const {
    constexpr int kEnough = 20;
    return count_ < kEnough ? 0.0 : width_m - sum_m_ / count_;
  }
  static void archive(auto& self, auto& bytes) { bytes(self.count_, self.sum_m_); }  // core/archive.hpp

 private:
  int count_ = 0;
  double sum_m_ = 0.0;
};

}  // namespace mlo
