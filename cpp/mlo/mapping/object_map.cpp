#include "mlo/mapping/object_map.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "mlo/core/robust_kernel.hpp"
#include "mlo/mapping/neighbourhood.hpp"

namespace mlo {
namespace {

// Neighbouring points of one surface err together: so many count as one.
constexpr double kPointsPerMeasurement = 4.0;

// A point within so many standard deviations lies on the map.
constexpr double kClose = 3.0;
// More points of one object are thinned: they say no more.
constexpr std::size_t kMaxPoints = 300;

// [x y yaw] of a motion in the plane, about the points' centre.
struct PlanarSums {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double cost = 0.0;
  int count = 0;
  int close = 0;      // of those, on the map
  double loss = 0.0;  // Geman and McClure's, of all points: 1 of one that is far from the map
};

void accumulate(const ShapeMatch& match, const Eigen::Vector3d& p_map, const Eigen::Vector2d& arm,
                const DynamicCheckConfig& config, PlanarSums& sums) {
  sums.loss += 1.0;
  if (match.num_directions == 0) return;
  const double d2 = match.squared_distance_m2(p_map);
  if (d2 > config.gate_m * config.gate_m) return;
  sums.loss -= 1.0 - d2 / (config.kernel_m * config.kernel_m + d2);
  if (d2 < kClose * kClose * config.point_sd_m * config.point_sd_m) ++sums.close;
  const double robust = geman_mcclure_weight(d2, config.kernel_m);
  const Eigen::Vector3d d = p_map - match.q_map.cast<double>();
  for (int i = 0; i < match.num_directions; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Eigen::Vector3d n = match.directions[k].cast<double>();
    const Eigen::Vector3d jacobian(n.x(), n.y(), arm.x() * n.y() - arm.y() * n.x());
    const double weight = robust * static_cast<double>(match.weights[k]);
    const double residual = n.dot(d);
    sums.H += weight * jacobian * jacobian.transpose();
    sums.g += weight * residual * jacobian;
    sums.cost += weight * residual * residual;
  }
  ++sums.count;
}

// Of every stride-th point, moved.
PlanarSums linearize(std::span<const Eigen::Vector3f> points_map, std::size_t stride,
                     const Eigen::Vector3d& motion, const LocalMap& at_rest, const DynamicCheckConfig& config,
                     const RefinementConfig& shapes) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points_map) center += p.cast<double>();
  center /= static_cast<double>(points_map.size());
  const Eigen::Matrix3d R = so3_exp({0.0, 0.0, motion.z()}).toRotationMatrix();
  PlanarSums sums;
  for (std::size_t k = 0; k < points_map.size(); k += stride) {
    const Eigen::Vector3d arm = R * (points_map[k].cast<double>() - center);
    const Eigen::Vector3d moved = center + arm + Eigen::Vector3d(motion.x(), motion.y(), 0.0);
    const NearestPoints near =
        at_rest.nearest(moved.cast<float>(), shapes.neighbours, static_cast<float>(config.gate_m));
    accumulate(describe(near, ExpectedShape::plane, shapes), moved, arm.head<2>(), config, sums);
  }
  return sums;
}

}  // namespace

void ObjectMap::insert(std::span<const Eigen::Vector3f> points_map, const SE3& T_map_object, double voxel_m) {
  const SE3 T_object_map = T_map_object.inverse();
  const auto inverse_voxel = static_cast<float>(1.0 / voxel_m);
  for (const Eigen::Vector3f& p_map : points_map) {
    const Eigen::Vector3f p_object = (T_object_map * p_map.cast<double>()).cast<float>();
    if (taken_.insert(voxel_key(p_object, inverse_voxel)).second) points_.push_back(p_object);
  }
}

void ObjectMap::clear() {
  points_.clear();
  taken_.clear();
}

double Displacement::sd_m() const {
  const double half_trace = 0.5 * covariance.trace();
  return std::sqrt(half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - covariance.determinant())));
}

double Displacement::significance() const {
  return std::sqrt(shift_map_m.dot(covariance.inverse() * shift_map_m));
}

Displacement measure_displacement(std::span<const Eigen::Vector3f> points_map, const LocalMap& at_rest,
                                  const DynamicCheckConfig& config, const RefinementConfig& shapes) {
  Displacement result;
  if (points_map.empty()) return result;
  const std::size_t stride = 1 + points_map.size() / kMaxPoints;
  const std::size_t num_points = (points_map.size() + stride - 1) / stride;
  const Eigen::Vector3d prior =
      Eigen::Vector3d(config.prior_shift_sd_m, config.prior_shift_sd_m, config.prior_turn_sd_rad)
          .cwiseAbs2()
          .cwiseInverse() *
      (config.point_sd_m * config.point_sd_m * kPointsPerMeasurement);
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  constexpr double kTiny = 1e-9;
  double loss_before = 0.0;
  PlanarSums sums;
  for (int i = 0; i < config.iterations; ++i) {
    sums = linearize(points_map, stride, motion, at_rest, config, shapes);
    if (sums.count < config.min_points) return result;
    result.fit_after = static_cast<double>(sums.close) / static_cast<double>(num_points);
    if (i == 0) {
      result.fit_before = result.fit_after;
      loss_before = sums.loss;
    }
    result.loss_gain = (loss_before - sums.loss) / std::max(loss_before, kTiny);
    sums.H.diagonal() += prior;
    sums.g += prior.cwiseProduct(motion);
    motion -= sums.H.ldlt().solve(sums.g);
  }
  const double variance =
      kPointsPerMeasurement * std::max(config.point_sd_m * config.point_sd_m, sums.cost / sums.count);
  result.known = true;
  result.shift_map_m = -motion.head<2>();
  result.covariance = (variance * sums.H.inverse()).topLeftCorner<2, 2>();
  return result;
}

}  // namespace mlo
