#pragma once

#include <span>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"

namespace mlo {

/// A detection's centre and where its track says it is.
struct BoxPair {
  Eigen::Vector2d measured_lidar_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d predicted_map_m = Eigen::Vector2d::Zero();
  double sd_m = 0.1;  ///< of the difference
};

/// How far the lidar's motion in a scan may be from that in the scan before, standard deviations.
struct EgoChange {
  double translation_m = 0.15;
  double rotation_rad = 0.01;
};

/// Planar pose of the lidar that best brings measured boxes to where their tracks are, starting from a
/// predicted pose that it is drawn to: robust least squares (Geman-McClure) in x, y and yaw, so that objects
/// which left their predicted course do not drag it along. Without pairs, the prediction.
SE3 ego_from_boxes(std::span<const BoxPair> pairs, const SE3& T_map_lidar_predicted, const EgoChange& change);

}  // namespace mlo
