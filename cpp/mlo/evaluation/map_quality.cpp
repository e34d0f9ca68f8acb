#include "mlo/evaluation/map_quality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Eigenvalues>

#include "mlo/core/parallel.hpp"
#include "mlo/evaluation/point_tree.hpp"

namespace mlo {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

struct LocalShape {
  double entropy = kUnknown;
  double thickness_m = kUnknown;  // only of planar neighbourhoods
};

LocalShape shape_at(const PointTree& tree, const PointCloud& cloud, std::size_t index,
                    const MapQualityOptions& options) {
  const Eigen::Vector3f& center = cloud.points[index];
  const MomentSum sum = neighbourhood(tree, cloud, center, options.radius_m);
  if (sum.size() < options.min_neighbors) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum.covariance(), Eigen::EigenvaluesOnly);
  const Eigen::Vector3d variances = solver.eigenvalues().cwiseMax(0.0);
  const double floor = options.sigma_floor_m * options.sigma_floor_m;
  LocalShape shape;
  shape.entropy = 0.5 * (2.0 * std::numbers::pi * std::numbers::e * (variances.array() + floor)).log().sum();
  if (is_sheet(variances, options.max_flatness, options.min_spread))
    shape.thickness_m = std::sqrt(variances(0));
  return shape;
}

}  // namespace

MapQuality map_quality(std::span<const Eigen::Vector3f> points, const MapQualityOptions& options) {
  PointCloud cloud;
  std::copy_if(points.begin(), points.end(), std::back_inserter(cloud.points),
               [](const Eigen::Vector3f& point) { return point.allFinite(); });
  MapQuality quality;
  quality.num_points = cloud.points.size();
  if (cloud.points.empty()) return quality;

  const PointTree tree(3, cloud);
  const std::vector<std::size_t> samples = sample_indices(cloud.points.size(), options.max_samples);
  std::vector<LocalShape> shapes(samples.size());
  parallel_for_each_index(
      samples.size(), [&](std::size_t i) { shapes[i] = shape_at(tree, cloud, samples[i], options); }, 64);

  std::vector<double> entropies;
  std::vector<double> thicknesses_m;
  for (const LocalShape& shape : shapes) {
    if (!std::isnan(shape.entropy)) entropies.push_back(shape.entropy);
    if (!std::isnan(shape.thickness_m)) thicknesses_m.push_back(shape.thickness_m);
  }
  quality.num_samples = entropies.size();
  quality.num_planar = thicknesses_m.size();
  if (!entropies.empty()) quality.mean_entropy = mean(entropies);
  if (!thicknesses_m.empty()) {
    quality.plane_residual_mean_m = mean(thicknesses_m);
    quality.plane_residual_median_m = median(thicknesses_m);
  }
  return quality;
}

}  // namespace mlo
