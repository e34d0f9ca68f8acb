#pragma once

#include <span>

#include "mlo/core/box.hpp"
#include "mlo/core/ego_motion.hpp"
#include "mlo/tracking/config.hpp"
#include "mlo/tracking/sgf_residuals.hpp"

namespace mlo {

/// What is known of one object in two scans.
struct SgfProblem {
  const ObjectTarget* target = nullptr;  ///< its points before; may be null or empty
  std::span<const ShapedPoint> points;   ///< its points now, as measured; may be empty
  std::optional<Box3d> previous_box;     ///< the track's, at the previous reference time
  std::optional<Box3d> current_box;      ///< the detector's, now
  double confidence = 1.0;               ///< mu of the current box
  Eigen::Vector3d center_sd_m = Eigen::Vector3d::Constant(0.1);  ///< of both boxes, along, across, up
  double yaw_sd_rad = 0.05;                                      ///< of both boxes
};

/// Relative motion H of an object, Eq. (13), by Levenberg-Marquardt on the manifold. The points look for
/// their voxels anew at each iteration.
/// @param H_guess  prediction; returned with a status that says so when there is too little to estimate from
/// @return T_target_source is H; status, covariance (of a perturbation about the object's place), matches
PoseEstimate estimate_relative_motion(const SgfProblem& problem, const SE3& H_guess, const SgfConfig& config);

}  // namespace mlo
