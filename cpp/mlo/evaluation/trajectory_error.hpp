#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "mlo/core/se3.hpp"

namespace mlo {

/// Poses of one body in one world frame. `frames` and `stamps_s` are as long as the poses, or empty where
/// unknown.
struct TrajectoryView {
  std::span<const std::size_t> frames;
  std::span<const double> stamps_s;
  std::span<const SE3> T_world_body;
};

enum class MatchBy { frame, time };

/// The same moment in truth and estimate. The two worlds may differ by any rigid motion, the bodies may not.
struct PosePair {
  std::size_t frame = 0;         ///< the estimate's frame number (its position in the list where it has none)
  std::optional<double> time_s;  ///< the truth's stamp, else the estimate's, where known
  SE3 T_world_truth;
  SE3 T_world_estimate;
};

struct PoseMatching {
  MatchBy by = MatchBy::frame;
  std::vector<PosePair> pairs;  ///< in the order of the estimate
  std::size_t unmatched_truth = 0;
  std::size_t unmatched_estimate = 0;
};

/// Pairs poses of equal frame number, or of nearest stamps no more than max_time_difference_s apart. A truth
/// pose is used once. Poses that are not finite stay unmatched, as does everything when the numbers asked for
/// are missing.
PoseMatching match_poses(const TrajectoryView& truth, const TrajectoryView& estimate, MatchBy by,
                         double max_time_difference_s = 0.02);

struct TrajectoryErrorOptions {
  std::vector<double> segment_lengths_m = {100, 200, 300, 400, 500, 600, 700, 800};
  std::size_t segment_step = 10;  ///< a segment starts at every n-th pair (KITTI: 10)
  double frame_period_s = 0.1;    ///< for speeds, where the poses have no stamps
};

/// Error of the relative motion E = (T_i^-1 T_j)_truth^-1 (T_i^-1 T_j)_estimate from pair i to the next one
/// j, divided by the number of frames between them (1 unless frames are missing; always 1 when matched by
/// time).
struct StepError {
  std::size_t frame = 0;  ///< of pair j
  double translation_m = 0.0;
  double rotation_deg = 0.0;
};

/// Mean errors of sub-paths per metre travelled, as in the KITTI odometry benchmark.
struct SegmentErrors {
  std::size_t count = 0;
  double translation_percent = 0.0;
  double rotation_deg_per_m = 0.0;
};

struct SegmentBin {
  double value = 0.0;  ///< length [m] or speed [m/s] that the bin stands for
  SegmentErrors errors;
};

struct TrajectoryErrors {
  std::size_t num_pairs = 0;
  double truth_path_m = 0.0;     ///< sum of the distances between the matched poses of the truth
  double estimate_path_m = 0.0;  ///< the same of the estimate

  /// Absolute trajectory error: RMSE of positions after the rigid alignment that minimises it; none without
  /// poses.
  std::optional<double> ate_m;
  SE3 T_truth_estimate;                   ///< that alignment, from the estimate's world to the truth's
  std::vector<double> position_errors_m;  ///< one per pair, after alignment

  /// Means of the steps' errors; none with fewer than two poses.
  std::optional<double> rte_m_per_frame;
  std::optional<double> rre_deg_per_frame;
  std::vector<StepError> steps;

  /// Distance of the last positions when the first poses coincide; none with fewer than two poses.
  std::optional<double> end_point_error_m;

  SegmentErrors segments;             ///< over all lengths; count 0 when the path is too short for any
  std::vector<SegmentBin> by_length;  ///< one per length asked for
  std::vector<SegmentBin>
      by_speed;  ///< one per 2 m/s from 2, each of the speeds less than 2 m/s away (as in KITTI)
};

/// The measures of a trajectory against the truth; docs/evaluation.md defines each.
TrajectoryErrors trajectory_errors(const PoseMatching& matching, const TrajectoryErrorOptions& options = {});

/// The rigid motion T that minimises sum |a_i - T b_i|^2 over the pairs' positions, a the truth's, b the
/// estimate's (Umeyama, PAMI 1991, without scale). Identity without pairs.
SE3 align_positions(std::span<const PosePair> pairs);

}  // namespace mlo
