#include "mlo/evaluation/scan_consistency.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <Eigen/Eigenvalues>

#include "mlo/core/parallel.hpp"
#include "mlo/evaluation/point_tree.hpp"

namespace mlo {
namespace {

// What a surface is, as in MapQualityOptions.
constexpr double kMaxFlatness = 0.1;
constexpr double kMinSpread = 0.1;

PointCloud finite_points(std::span<const Eigen::Vector3f> points) {
  PointCloud cloud;
  std::copy_if(points.begin(), points.end(), std::back_inserter(cloud.points),
               [](const Eigen::Vector3f& point) { return point.allFinite(); });
  return cloud;
}

// Distance of a point from the plane of its neighbours; NaN where they are none.
double distance_from_plane(const PointTree& tree, const PointCloud& first, const Eigen::Vector3f& point,
                           const ScanConsistencyOptions& options) {
  const MomentSum near = neighbourhood(tree, first, point, options.radius_m);
  if (near.size() < options.min_neighbors) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(near.covariance());
  if (!is_sheet(solver.eigenvalues(), kMaxFlatness, kMinSpread)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return std::abs(solver.eigenvectors().col(0).dot(near.mean_from_origin()));
}

}  // namespace

std::optional<double> ScanConsistency::median_m() const {
  return residuals_m.empty() ? std::nullopt : std::optional(median(residuals_m));
}

std::optional<double> ScanConsistency::mean_m() const {
  return residuals_m.empty() ? std::nullopt : std::optional(mean(residuals_m));
}

ScanConsistency scan_consistency(std::span<const Eigen::Vector3f> first,
                                 std::span<const Eigen::Vector3f> second,
                                 const ScanConsistencyOptions& options) {
  const PointCloud planes = finite_points(first);
  const PointCloud points = finite_points(second);
  ScanConsistency consistency;
  if (planes.points.empty()) return consistency;
  const PointTree tree(3, planes);
  const std::vector<std::size_t> samples = sample_indices(points.points.size(), options.max_samples);
  std::vector<double> distances_m(samples.size());
  parallel_for_each_index(
      samples.size(),
      [&](std::size_t i) {
        distances_m[i] = distance_from_plane(tree, planes, points.points[samples[i]], options);
      },
      64);
  std::copy_if(distances_m.begin(), distances_m.end(), std::back_inserter(consistency.residuals_m),
               [](double distance_m) { return !std::isnan(distance_m); });
  return consistency;
}

}  // namespace mlo
