#pragma once

#include <Eigen/Core>

#include "mlo/core/se3.hpp"

namespace mlo {

/// How the points of a scan relate to its reference time.
struct SweepTiming {
  bool motion_compensated = false;  ///< points are already where they would be at the reference time
  double reference_fraction = 0.5;  ///< sweep fraction of the reference time; 1 is the paper's end of sweep
  double sweeps_since_previous = 1.0;  ///< between the reference times; more than 1 after missing scans
};

/// Motion of the lidar during a sweep, constant in the body frame.
///
/// The paper refers points to the end of their sweep (reference_fraction 1); the middle (0.5) keeps errors of
/// the assumed velocity smaller and unbiased. For motion-compensated scans use SweepMotion::none().
class SweepMotion {
 public:
  /// @param motion_per_sweep    of the lidar from the start of a sweep to its end
  /// @param reference_fraction  sweep fraction to which points are brought
  SweepMotion(const SE3& motion_per_sweep, double reference_fraction)
      : xi_(motion_per_sweep.log()),
        is_still_((xi_.array() == 0.0).all()),
        reference_fraction_(reference_fraction) {}
  static SweepMotion none() { return {SE3(), 0.5}; }

  /// The motion within a sweep that an increment between the reference times of two scans implies.
  static SweepMotion from_increment(const SE3& T_previous_current, const SweepTiming& timing) {
    if (timing.motion_compensated) return none();
    return {interpolate(T_previous_current, 1.0 / timing.sweeps_since_previous), timing.reference_fraction};
  }

  /// Pose of the lidar at a sweep fraction, in the lidar frame at the reference time; Eq. (5) as in NOTES.
  SE3 T_reference_at(double sweep_fraction) const {
    return SE3::exp((sweep_fraction - reference_fraction_) * xi_);
  }

  /// The point where it would have been measured at the reference time.
  Eigen::Vector3d undistort(const Eigen::Vector3d& p_lidar, double sweep_fraction) const {
    return moved(p_lidar, sweep_fraction - reference_fraction_);
  }

  /// The inverse: where a point at rest was, in the lidar frame, when the lidar measured at a sweep fraction.
  Eigen::Vector3d distort(const Eigen::Vector3d& p_lidar, double sweep_fraction) const {
    return moved(p_lidar, reference_fraction_ - sweep_fraction);
  }

  /// Nothing moves: points stay where they were measured.
  bool is_still() const { return is_still_; }
  double reference_fraction() const { return reference_fraction_; }

  static void archive(auto& self, auto& bytes) {
    bytes(self.xi_, self.is_still_, self.reference_fraction_);
  }  // core/archive.hpp

 private:
  // By a share of the motion, as the third-order series of the exponential: exact to a millimetre at 50 m for
  // turns up to 6 degrees a sweep.
  Eigen::Vector3d moved(const Eigen::Vector3d& p_lidar, double share) const {
    if (is_still_) return p_lidar;
    const Eigen::Vector3d w = share * xi_.tail<3>();
    const Eigen::Vector3d first = share * xi_.head<3>() + w.cross(p_lidar);
    const Eigen::Vector3d second = w.cross(first);
    return p_lidar + first + 0.5 * second + w.cross(second) / 6.0;
  }

  SE3::Tangent xi_;
  bool is_still_;
  double reference_fraction_;
};

}  // namespace mlo
