#pragma once

#include <optional>

#include "mlo/core/features.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/core/sweep_motion.hpp"

namespace mlo {

/// Takes measured points of the current scan into the previous scan's lidar frame (at its reference time) by
/// the increment being estimated; distortion is removed with the same increment: interpolate(delta, 1 + s -
/// r).
class Placement {
 public:
  Placement(const SE3& T_previous_current, const SweepTiming& timing)
      : T_previous_current_(T_previous_current) {
    if (timing.motion_compensated) return;
    motion_ = SweepMotion::from_increment(T_previous_current, timing);
    sweeps_since_previous_ = timing.sweeps_since_previous;
  }

  Eigen::Vector3d operator()(const FeaturePoint& feature) const {
    return T_previous_current_ * at_reference(feature);
  }
  /// The point in the current lidar frame at the reference time.
  Eigen::Vector3d at_reference(const FeaturePoint& feature) const {
    const Eigen::Vector3d p = feature.p_lidar.cast<double>();
    return motion_ ? motion_->undistort(p, feature.sweep_fraction) : p;
  }
  /// Share of a change of the increment that reaches the point: 1 + s - r (of one sweep), to first order in
  /// its rotation.
  double gain(const FeaturePoint& feature) const {
    if (!motion_) return 1.0;
    return 1.0 + (feature.sweep_fraction - motion_->reference_fraction()) / sweeps_since_previous_;
  }

 private:
  SE3 T_previous_current_;
  std::optional<SweepMotion> motion_;
  double sweeps_since_previous_ = 1.0;
};

}  // namespace mlo
