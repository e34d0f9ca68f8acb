#include "mlo/mapping/neighbourhood.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

namespace mlo {
namespace {

constexpr int kMinNeighbours = 5;
// LOAM's edge test: the largest variance stands out by this factor.
constexpr float kLineElongation = 3.0F;

struct PrincipalAxes {
  Eigen::Vector3f mean;
  Eigen::Vector3f variances;  // ascending
  Eigen::Matrix3f axes;       // columns
};

PrincipalAxes principal_axes(const NearestPoints& neighbours) {
  PrincipalAxes result;
  const auto n = static_cast<float>(neighbours.count);
  result.mean.setZero();
  for (int i = 0; i < neighbours.count; ++i) result.mean += neighbours.points[static_cast<std::size_t>(i)];
  result.mean /= n;
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
  for (int i = 0; i < neighbours.count; ++i) {
    const Eigen::Vector3f d = neighbours.points[static_cast<std::size_t>(i)] - result.mean;
    covariance += d * d.transpose();
  }
  covariance /= n;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen;
  eigen.computeDirect(covariance);
  result.variances = eigen.eigenvalues().cwiseMax(0.0F);
  result.axes = eigen.eigenvectors();
  return result;
}

void add_direction(ShapeMatch& match, const Eigen::Vector3f& direction, float weight) {
  match.directions[static_cast<std::size_t>(match.num_directions)] = direction;
  match.weights[static_cast<std::size_t>(match.num_directions)] = weight;
  ++match.num_directions;
}

}  // namespace

double ShapeMatch::squared_distance_m2(const Eigen::Vector3d& p_map) const {
  const Eigen::Vector3d d = p_map - q_map.cast<double>();
  double sum = 0.0;
  for (int i = 0; i < num_directions; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double e = directions[k].cast<double>().dot(d);
    sum += static_cast<double>(weights[k]) * e * e;
  }
  return sum;
}

ShapeMatch describe(const NearestPoints& neighbours, ExpectedShape expected, const RefinementConfig& config) {
  ShapeMatch match;
  if (neighbours.count < kMinNeighbours) return match;
  const PrincipalAxes shape = principal_axes(neighbours);
  match.q_map = shape.mean;
  const auto max_variance = static_cast<float>(config.max_thickness_m * config.max_thickness_m);
  const bool flat = shape.variances(0) <= max_variance &&
                    shape.variances(0) <= static_cast<float>(config.max_flatness) * shape.variances(1);

  if (config.shape_model == ShapeModel::distribution) {
    const auto noise2 = static_cast<float>(config.noise_m * config.noise_m);
    for (int i = 0; i < (flat ? 1 : 3); ++i) {
      add_direction(match, shape.axes.col(i), flat ? 1.0F : noise2 / (noise2 + shape.variances(i)));
    }
  } else if (expected == ExpectedShape::line) {
    if (shape.variances(2) < kLineElongation * shape.variances(1)) return match;
    for (int i = 0; i < 2; ++i) add_direction(match, shape.axes.col(i), 1.0F);
  } else if (flat) {
    add_direction(match, shape.axes.col(0), 1.0F);
  }
  return match;
}

}  // namespace mlo
