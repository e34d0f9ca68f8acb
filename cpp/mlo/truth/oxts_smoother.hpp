#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/gauss_newton.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/io/oxts.hpp"

namespace mlo {

/// What the filter takes for granted beside the accuracies that the records state themselves.
struct OxtsSmootherOptions {
  // Standard deviations of what the records do not rate (the unit's data sheet gives 0.03 and 0.1 degrees).
  double roll_pitch_deg = 0.03;
  double heading_deg = 0.1;
  double rate_deg_s = 0.15;  ///< of the angular rates, with what is lost between samples 0.1 s apart
  // How much acceleration and angular rate wander in a second: less smooths more, and cuts what is real.
  double acceleration_walk_m_s2 = 2.0;  ///< [m/s^2 per sqrt(s)]
  double rate_walk_deg_s = 20.0;        ///< [deg/s per sqrt(s)]
  // Records that claim to be better than this are not believed.
  double min_position_accuracy_m = 0.005;
  double min_velocity_accuracy_m_s = 0.005;
};

/// State of the IMU at one time.
struct SmoothedPose {
  using Matrix6d = NormalEquations::Matrix6d;

  double stamp_s = 0.0;
  SE3 T_world_imu;  ///< world: x east, y north, z up, about the place of the first record
  Eigen::Vector3d velocity_world_m_s = Eigen::Vector3d::Zero();
  /// Of a perturbation [translation; rotation] ([m], [rad]) at the IMU's origin with the world's axes.
  Matrix6d covariance = Matrix6d::Zero();
};

/// Poses at any times from all records, before and after: an extended Kalman filter over place, velocity,
/// acceleration, attitude and angular rate (acceleration and rate walk at random, as in Moore and Stouch, IAS
/// 2014, which the paper takes its ground truth with), then a Rauch-Tung-Striebel smoother. Errors of the
/// records are taken to be independent of each other; those of satellite positions are not, so that the
/// covariance says little of slow drifts.
/// @param records   with stamps that grow and with motion; at least one
/// @param stamps_s  when poses are wanted, in any order; beyond the records they are predictions
/// @return one for each stamp, in their order
std::vector<SmoothedPose> smooth_oxts(std::span<const OxtsRecord> records, std::span<const double> stamps_s,
                                      const OxtsSmootherOptions& options = {});

}  // namespace mlo
