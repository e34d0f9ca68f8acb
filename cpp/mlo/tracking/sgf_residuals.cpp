#include "mlo/tracking/sgf_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace mlo {
namespace {

/// Matrix of the Lie bracket, for tangents [translation; rotation].
Eigen::Matrix<double, 6, 6> bracket(const SE3::Tangent& xi) {
  Eigen::Matrix<double, 6, 6> ad = Eigen::Matrix<double, 6, 6>::Zero();
  ad.topLeftCorner<3, 3>() = skew(xi.tail<3>());
  ad.topRightCorner<3, 3>() = skew(xi.head<3>());
  ad.bottomRightCorner<3, 3>() = skew(xi.tail<3>());
  return ad;
}

std::vector<Eigen::Vector3d> thinned(std::span<const Eigen::Vector3d> points, const ShapeConfig& config) {
  std::vector<Eigen::Vector3d> finite;
  for (const Eigen::Vector3d& p : points) {
    if (p.allFinite() && p.cwiseAbs().maxCoeff() < 1e5) finite.push_back(p);
  }
  const auto position = [](const Eigen::Vector3d& p) { return Eigen::Vector3f(p.cast<float>()); };
  std::vector<Eigen::Vector3d> kept = downsample_first<Eigen::Vector3d>(
      std::span<const Eigen::Vector3d>(finite), static_cast<float>(config.thin_voxel_m), position);
  if (kept.size() <= config.max_points) return kept;
  std::vector<Eigen::Vector3d> fewer;
  for (std::size_t i = 0; i < config.max_points; ++i)
    fewer.push_back(kept[i * kept.size() / config.max_points]);
  return fewer;
}

/// Covariance of the nearest neighbours with the eigenvalues of a piece of surface.
Eigen::Matrix3d surface_covariance(const std::vector<Eigen::Vector3d>& points, std::size_t index,
                                   const ShapeConfig& config,
                                   std::vector<std::pair<double, std::size_t>>& order) {
  const auto count = std::min(static_cast<std::size_t>(config.neighbours), points.size());
  order.clear();
  for (std::size_t j = 0; j < points.size(); ++j)
    order.emplace_back((points[j] - points[index]).squaredNorm(), j);
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count) - 1, order.end());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < count; ++k) mean += points[order[k].second] / static_cast<double>(count);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d d = points[order[k].second] - mean;
    scatter += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);
  const double wide = config.wide_m * config.wide_m;
  // Too few points, or all on a line, have no surface: nothing is known then but that the point is about
  // here.
  constexpr double kLineRatio = 1e-3;
  const bool is_surface = count >= 4 && eigen.eigenvalues()(1) > kLineRatio * eigen.eigenvalues()(2);
  const double thick = is_surface ? config.thick_m * config.thick_m : wide;
  const Eigen::Vector3d values(thick, wide, wide);
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

std::array<BoxPlane, 6> planes_of(const Box3d& box) {
  const Eigen::Vector3d axes[3] = {{std::cos(box.yaw_rad), std::sin(box.yaw_rad), 0.0},
                                   {-std::sin(box.yaw_rad), std::cos(box.yaw_rad), 0.0},
                                   Eigen::Vector3d::UnitZ()};
  std::array<BoxPlane, 6> planes;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const Eigen::Vector3d normal = (i % 2 == 0 ? 1.0 : -1.0) * axes[i / 2];
    const double half_m = 0.5 * box.size_lwh_m(static_cast<Eigen::Index>(i / 2));
    planes[i] = {normal, -normal.dot(box.center_lidar_m) - half_m};
  }
  return planes;
}

VectorResidual plane_residual(const BoxPlane& previous, const BoxPlane& current, const SE3& H,
                              const Eigen::Vector3d& origin) {
  const Eigen::Vector3d F = H.rotation() * current.normal;
  const double previous_d_m = previous.d_m + previous.normal.dot(origin);
  const double moved_d_m = current.d_m - (H.translation() - origin).dot(F);
  VectorResidual residual;
  residual.value = previous.normal * previous_d_m - F * moved_d_m;
  residual.jacobian.leftCols<3>() = F * F.transpose();
  residual.jacobian.rightCols<3>() = moved_d_m * skew(F) - F * F.cross(origin).transpose();
  return residual;
}

std::vector<ShapedPoint> shaped_points(std::span<const Eigen::Vector3d> points, const ShapeConfig& config) {
  const std::vector<Eigen::Vector3d> kept = thinned(points, config);
  std::vector<ShapedPoint> shaped(kept.size());
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    shaped[i].p_lidar = kept[i];
    shaped[i].covariance = surface_covariance(kept, i, config, order);
  }
  return shaped;
}

ObjectTarget::ObjectTarget(std::span<const ShapedPoint> points, double voxel_m) : voxel_m_(voxel_m) {
  const auto inverse_size = static_cast<float>(1.0 / voxel_m);
  for (const ShapedPoint& point : points) {
    Voxel& voxel = voxels_[voxel_key(point.p_lidar.cast<float>(), inverse_size)];
    voxel.mean += point.p_lidar;
    voxel.covariance += point.covariance;
    ++voxel.count;
  }
  for (auto it = voxels_.begin(); it != voxels_.end(); ++it) {
    it.value().mean /= it->second.count;
    it.value().covariance /= it->second.count;
  }
}

const ObjectTarget::Voxel* ObjectTarget::find(const Eigen::Vector3d& p) const {
  constexpr int kSteps[7][3] = {{0, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {0, -1, 0},
                                {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  const VoxelKey center = voxel_key(p.cast<float>(), static_cast<float>(1.0 / voxel_m_));
  const Voxel* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& step : kSteps) {
    if (nearest != nullptr && &step == &kSteps[1]) break;  // its own voxel will do
    const auto found = voxels_.find(VoxelKey{center.x + step[0], center.y + step[1], center.z + step[2]});
    if (found == voxels_.end()) continue;
    const double distance = (found->second.mean - p).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = &found->second;
  }
  return nearest;
}

RelativeMotion::RelativeMotion(const SE3& H)
    : rotation_(H.rotation().toRotationMatrix()),
      translation_(H.translation()),
      xi_(H.log()),
      bracket_(bracket(xi_)) {}

Eigen::Vector3d RelativeMotion::move(const ShapedPoint& point) const {
  if (point.share == 1.0) return rotation_ * point.p_lidar + translation_;
  return SE3::exp(point.share * xi_) * point.p_lidar;
}

Matrix36 RelativeMotion::jacobian(const ShapedPoint& point, const Eigen::Vector3d& moved) const {
  Matrix36 J;
  J << Eigen::Matrix3d::Identity(), -skew(moved);
  if (point.share == 1.0) return J;
  // exp(a log(exp(xi) H)) = exp(a (I + (a - 1) / 2 ad(log H) + ...) xi) exp(a log H)
  return point.share * (J + 0.5 * (point.share - 1.0) * J * bracket_);
}

VectorResidual point_residual(const ShapedPoint& point, const Eigen::Vector3d& voxel_mean,
                              const RelativeMotion& motion) {
  const Eigen::Vector3d moved = motion.move(point);
  return {voxel_mean - moved, -motion.jacobian(point, moved)};
}

Eigen::Matrix3d point_covariance(const ShapedPoint& point, const ObjectTarget::Voxel& voxel, const SE3& H) {
  // Over one scan the rotation within the sweep is too small to matter for a covariance: R_j ~ R.
  const Eigen::Matrix3d R = H.rotation().toRotationMatrix();
  return voxel.covariance + R * point.covariance * R.transpose();
}

}  // namespace mlo
