#pragma once

#include <cstddef>
#include <optional>

#include "mlo/core/ego_motion.hpp"
#include "mlo/core/features.hpp"
#include "mlo/odometry/config.hpp"
#include "mlo/odometry/consistency_check.hpp"
#include "mlo/odometry/placement.hpp"
#include "mlo/odometry/reference_scan.hpp"

namespace mlo {

/// How the lidar moved from the previous scan to the current one.
struct EgoOdometryResult {
  /// T_previous_current: maps points of the current lidar frame to the previous one, both at their scans'
  /// reference times (delta of the paper). Where it is not usable() it is the prediction.
  PoseEstimate increment;
  ConsistencyReport consistency;
  std::size_t num_ground_matches = 0;
  std::size_t num_edge_matches = 0;
  std::size_t num_surface_matches = 0;
  /// Too few surface features are flatter than S_a, so that all of them took part.
  bool flat_surfaces_scarce = false;
  /// The two steps were not possible for want of ground, so that all six parameters were estimated at once.
  bool ground_scarce = false;
};

/// Scan-to-scan odometry (paper, section III-C-1): consistency check, then [t_z, roll, pitch] from the ground
/// and [t_x, t_y, yaw] from edges and from surfaces flatter than S_a, or all six at once. Axes are those of
/// the previous lidar frame. Distortion of the current scan is removed with the increment being estimated.
/// @param guess   prediction of T_previous_current; without one (first scans) motions around rest are
/// searched
/// @param timing  of the current scan; the previous one has no distortion left
/// @param frame   number of the scan: with the configuration's seed it decides the random samples
EgoOdometryResult estimate_ego(const Percept& current, const ReferenceScan& previous,
                               const std::optional<SE3>& guess, const SweepTiming& timing,
                               const OdometryConfig& config, std::size_t frame);

}  // namespace mlo
