#pragma once

#include <cstddef>
#include <vector>

#include "mlo/odometry/config.hpp"
#include "mlo/odometry/placement.hpp"
#include "mlo/odometry/reference_scan.hpp"

namespace mlo {

/// Features of the current scan that are to be matched: chi_f, psi_f, zeta_f.
struct EgoFeatures {
  std::vector<FeaturePoint> ground;
  std::vector<FeaturePoint> edge;
  std::vector<FeaturePoint> surface;

  std::size_t size() const { return ground.size() + edge.size() + surface.size(); }
};

/// What the consistency check found.
struct ConsistencyReport {
  bool run = false;
  bool passed = false;        ///< false: no motion had enough support, so that all features went on unchecked
  double share = 0.0;         ///< of the counted features that agree with the best motion
  std::size_t num_tried = 0;  ///< motions
  std::size_t num_before = 0;  ///< features before and after
  std::size_t num_after = 0;
};

struct ConsistencyResult {
  EgoFeatures features;  ///< with a tilde in the paper; all of them when the check did not pass
  ConsistencyReport report;
};

/// Algorithm 1: looks for the motion that most features agree with, and keeps those that do. Motions come
/// from random samples of ground and edge matches around the best motion so far, at first the prediction,
/// which is tried too. The ICP model is one Gauss-Newton step on Eq. (3) and (4): nearest points as pairs
/// would pull every sample towards no motion, because scan lines on the ground move along with the lidar. The
/// result depends on the configuration's seed and the frame number only.
ConsistencyResult check_consistency(const EgoFeatures& features, const ReferenceScan& previous,
                                    const SE3& T_previous_current_guess, const SweepTiming& timing,
                                    const OdometryConfig& config, std::size_t frame);

}  // namespace mlo
