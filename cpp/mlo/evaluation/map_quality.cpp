#include "mlo/evaluation/map_quality.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Eigenvalues>

#include "mlo/core/parallel.hpp"
#include "mlo/evaluation/point_tree.hpp"

namespace mlo {
namespace {

// Result set of a radius search that sums up what it is given instead of storing it.
class MomentSum {
 public:
  MomentSum(const PointCloud& cloud, const Eigen::Vector3f& origin, float radius_squared)
      : cloud_(cloud), origin_(origin), radius_squared_(radius_squared) {}

  // The interface that nanoflann calls.
  std::size_t size() const { return count_; }
  bool full() const { return true; }
  float worstDist() const { return radius_squared_; }
  bool addPoint(float distance_squared, std::size_t index) {
    if (distance_squared >= radius_squared_) return true;
    const Eigen::Vector3d d = (cloud_.points[index] - origin_).cast<double>();
    ++count_;
    sum_ += d;
    sum_squares_ += d * d.transpose();
    return true;
  }

  Eigen::Matrix3d covariance() const {
    const auto n = static_cast<double>(count_);
    return sum_squares_ / n - (sum_ / n) * (sum_ / n).transpose();
  }

 private:
  const PointCloud& cloud_;
  Eigen::Vector3f origin_;
  float radius_squared_;
  std::size_t count_ = 0;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d sum_squares_ = Eigen::Matrix3d::Zero();
};

// Bit mixer of splitmix64: spreads indices evenly, so that samples do not fall into step with the order of
// points.
std::uint64_t mixed(std::uint64_t value) {
  value += 0x9E3779B97F4A7C15ULL;
  value = (value ^ (value >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  value = (value ^ (value >> 27U)) * 0x94D049BB133111EBULL;
  return value ^ (value >> 31U);
}

std::vector<std::size_t> sample_indices(std::size_t count, std::size_t max_samples) {
  const std::size_t every = std::max<std::size_t>(1, count / std::max<std::size_t>(1, max_samples));
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < count; ++i) {
    if (mixed(i) % every == 0) indices.push_back(i);
  }
  return indices;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct LocalShape {
  double entropy = kNone;
  double thickness_m = kNone;  // only of planar neighbourhoods
};

LocalShape shape_at(const PointTree& tree, const PointCloud& cloud, std::size_t index,
                    const MapQualityOptions& options) {
  const Eigen::Vector3f& center = cloud.points[index];
  MomentSum sum(cloud, center, static_cast<float>(options.radius_m * options.radius_m));
  tree.radiusSearchCustomCallback(center.data(), sum, nanoflann::SearchParams());
  if (sum.size() < options.min_neighbors) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum.covariance(), Eigen::EigenvaluesOnly);
  const Eigen::Vector3d variances = solver.eigenvalues().cwiseMax(0.0);
  const double floor = options.sigma_floor_m * options.sigma_floor_m;
  LocalShape shape;
  shape.entropy = 0.5 * (2.0 * std::numbers::pi * std::numbers::e * (variances.array() + floor)).log().sum();
  const bool thin = variances(0) < options.max_flatness * variances(1);
  const bool wide = variances(1) > options.min_spread * variances(2);
  if (thin && wide) shape.thickness_m = std::sqrt(variances(0));
  return shape;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double median(std::vector<double> values) {
  const auto upper = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), upper, values.end());
  if (values.size() % 2 == 1) return *upper;
  return 0.5 * (*upper + *std::max_element(values.begin(), upper));
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
