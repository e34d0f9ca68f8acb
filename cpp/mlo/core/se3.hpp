#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mlo {

/// 3x3 matrix [v]_x with [v]_x w = v x w.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Rotation vector (axis times angle [rad]) to rotation and back; the angle of so3_log is in [0, pi].
Eigen::Quaterniond so3_exp(const Eigen::Vector3d& rotation_vector_rad);
Eigen::Vector3d so3_log(const Eigen::Quaterniond& rotation);

/// A rigid motion or pose. `T_target_source` maps points: p_target = T_target_source * p_source.
/// Tangent vectors are [translation; rotation] ([m], [rad]); perturbations act on the left:
/// exp(xi) * T_target_source (docs/conventions.md).
class SE3 {
 public:
  using Tangent = Eigen::Matrix<double, 6, 1>;
  using Adjoint = Eigen::Matrix<double, 6, 6>;

  SE3() = default;
  /// The rotation is normalised.
  SE3(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation_m)
      : rotation_(rotation.normalized()), translation_(translation_m) {}
  /// The rotation part is projected onto SO(3) (nearest in the Frobenius norm).
  static SE3 from_matrix(const Eigen::Matrix4d& matrix);
  static SE3 exp(const Tangent& xi);

  /// [translation; rotation]; unique while the rotation angle is below pi.
  Tangent log() const;
  SE3 inverse() const;
  SE3 operator*(const SE3& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& p_source) const {
    return rotation_ * p_source + translation_;
  }
  /// Ad with T exp(xi) = exp(Ad xi) T.
  Adjoint adjoint() const;
  Eigen::Matrix4d matrix() const;

  const Eigen::Quaterniond& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }
  double rotation_angle_rad() const { return so3_log(rotation_).norm(); }
  bool is_finite() const { return rotation_.coeffs().allFinite() && translation_.allFinite(); }

  /// Every bit comes back: the rotation is not normalised again (core/archive.hpp).
  static void archive(auto& self, auto& bytes) { bytes(self.rotation_, self.translation_); }

 private:
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

/// Part of a motion on the manifold: exp(fraction * log(motion)); fractions outside [0, 1] extrapolate.
SE3 interpolate(const SE3& motion, double fraction);

}  // namespace mlo
