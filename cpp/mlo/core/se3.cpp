#include "mlo/core/se3.hpp"

#include <cmath>

#include <Eigen/SVD>

namespace mlo {
namespace {

// Below this angle the closed forms lose digits and their series are exact to double precision.
constexpr double kSmallAngleRad = 1e-5;

// V with translation = V(w) v, the left Jacobian of SO(3).
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = skew(w);
  if (angle < kSmallAngleRad) return Eigen::Matrix3d::Identity() + 0.5 * W + W * W / 6.0;
  const double angle2 = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / angle2 * W +
         (angle - std::sin(angle)) / (angle2 * angle) * W * W;
}

Eigen::Matrix3d left_jacobian_inverse(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = skew(w);
  if (angle < kSmallAngleRad) return Eigen::Matrix3d::Identity() - 0.5 * W + W * W / 12.0;
  const double half = 0.5 * angle;
  return Eigen::Matrix3d::Identity() - 0.5 * W + (1.0 - half / std::tan(half)) / (angle * angle) * W * W;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  // sin(angle/2)/angle, by its series near zero
  const double scale = angle < kSmallAngleRad ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond q(std::cos(0.5 * angle), scale * w.x(), scale * w.y(), scale * w.z());
  q.normalize();
  return q;
}

Eigen::Vector3d so3_log(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * rotation.vec();
  const double w = sign * rotation.w();
  const double norm = v.norm();
  if (norm < kSmallAngleRad) return 2.0 * v / w * (1.0 - norm * norm / (3.0 * w * w));
  return 2.0 * std::atan2(norm, w) / norm * v;
}

SE3 SE3::from_matrix(const Eigen::Matrix4d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix.topLeftCorner<3, 3>(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) *= -1.0;
  const Eigen::Matrix3d R = U * svd.matrixV().transpose();
  return {Eigen::Quaterniond(R), matrix.topRightCorner<3, 1>()};
}

SE3 SE3::exp(const Tangent& xi) {
  const Eigen::Vector3d w = xi.tail<3>();
  return {so3_exp(w), left_jacobian(w) * xi.head<3>()};
}

SE3::Tangent SE3::log() const {
  const Eigen::Vector3d w = so3_log(rotation_);
  Tangent xi;
  xi << left_jacobian_inverse(w) * translation_, w;
  return xi;
}

SE3 SE3::inverse() const {
  const Eigen::Quaterniond inverse_rotation = rotation_.conjugate();
  return {inverse_rotation, -(inverse_rotation * translation_)};
}

SE3 SE3::operator*(const SE3& other) const {
  // The constructor renormalises: products of thousands of increments stay rotations.
  return {rotation_ * other.rotation_, rotation_ * other.translation_ + translation_};
}

SE3::Adjoint SE3::adjoint() const {
  const Eigen::Matrix3d R = rotation_.toRotationMatrix();
  Adjoint ad = Adjoint::Zero();
  ad.topLeftCorner<3, 3>() = R;
  ad.bottomRightCorner<3, 3>() = R;
  ad.topRightCorner<3, 3>() = skew(translation_) * R;
  return ad;
}

Eigen::Matrix4d SE3::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation_.toRotationMatrix();
  m.topRightCorner<3, 1>() = translation_;
  return m;
}

SE3 interpolate(const SE3& motion, double fraction) {
  return SE3::exp(fraction * motion.log());
}

}  // namespace mlo
