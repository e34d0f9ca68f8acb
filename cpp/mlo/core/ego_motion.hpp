#pragma once

#include <cstddef>
#include <string_view>

#include "mlo/core/gauss_newton.hpp"
#include "mlo/core/se3.hpp"

namespace mlo {

/// How an estimate ended.
enum class EstimateStatus { not_run, converged, max_iterations, degenerate, too_few_matches };

constexpr std::string_view to_string(EstimateStatus status) {
  switch (status) {
    case EstimateStatus::converged:
      return "converged";
    case EstimateStatus::max_iterations:
      return "max_iterations";
    case EstimateStatus::degenerate:
      return "degenerate";
    case EstimateStatus::too_few_matches:
      return "too_few_matches";
    case EstimateStatus::not_run:
      break;
  }
  return "not_run";
}

/// A pose or increment with what is known of its quality. Starts as "not run".
struct PoseEstimate {
  SE3 T_target_source;
  EstimateStatus status = EstimateStatus::not_run;
  /// Of a perturbation [translation; rotation] ([m], [rad]) at the source frame's own origin, with the axes
  /// of the target frame.
  NormalEquations::Matrix6d covariance = NormalEquations::Matrix6d::Zero();
  int degenerate_directions = 0;
  std::size_t num_matches = 0;
  int iterations = 0;
  double rms_residual_m = 0.0;

  /// True when the data, not only the prediction, decided the pose.
  bool usable() const {
    return status == EstimateStatus::converged || status == EstimateStatus::max_iterations ||
           status == EstimateStatus::degenerate;
  }
  static void archive(auto& self, auto& bytes) {  // core/archive.hpp
    bytes(self.T_target_source, self.status, self.covariance, self.degenerate_directions, self.num_matches,
          self.iterations, self.rms_residual_m);
  }
};

}  // namespace mlo
