#pragma once

#include <Eigen/Core>

#include "mlo/core/gauss_newton.hpp"
#include "mlo/odometry/config.hpp"
#include "mlo/odometry/consistency_check.hpp"
#include "mlo/odometry/matching.hpp"
#include "mlo/odometry/placement.hpp"
#include "mlo/odometry/reference_scan.hpp"

namespace mlo {

/// Which parameters [t_x t_y t_z roll pitch yaw] are estimated, and from what.
struct AlignmentTask {
  bool ground = true;
  bool background = true;  ///< edges and surfaces
  Eigen::Matrix<bool, 6, 1> active = Eigen::Matrix<bool, 6, 1>::Constant(true);
};

/// What aligning leaves behind.
struct Alignment {
  SE3 T_previous_current;
  bool enough_matches = false;  ///< false: nothing was estimated
  bool converged = false;
  int iterations = 0;
  int degenerate_directions = 0;  ///< among the active parameters; they keep the start's value
  NormalEquations sums;           ///< of the last step, in all six parameters
  std::size_t num_ground = 0;     ///< matches
  std::size_t num_edge = 0;
  std::size_t num_surface = 0;

  std::size_t num_matches() const { return num_ground + num_edge + num_surface; }
};

/// Alternates matching and Gauss-Newton steps on Eq. (3) and (4), weighted by a Geman-McClure kernel, until
/// the pose stays or max_matchings are spent.
Alignment align(const EgoFeatures& features, const ReferenceScan& previous, const SE3& T_start,
                const SweepTiming& timing, const AlignmentTask& task, const OdometryConfig& config);

}  // namespace mlo
