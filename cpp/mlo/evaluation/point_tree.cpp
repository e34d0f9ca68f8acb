#include "mlo/evaluation/point_tree.hpp"

#include <algorithm>
#include <cstdint>

namespace mlo {
namespace {

// Bit mixer of splitmix64.
std::uint64_t mixed(std::uint64_t value) {
  value += 0x9E3779B97F4A7C15ULL;
  value = (value ^ (value >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  value = (value ^ (value >> 27U)) * 0x94D049BB133111EBULL;
  return value ^ (value >> 31U);
}

}  // namespace

MomentSum neighbourhood(const PointTree& tree, const PointCloud& cloud, const Eigen::Vector3f& origin,
                        double radius_m) {
  MomentSum sum(cloud, origin, static_cast<float>(radius_m * radius_m));
  tree.radiusSearchCustomCallback(origin.data(), sum, nanoflann::SearchParams());
  return sum;
}

bool is_sheet(const Eigen::Vector3d& variances, double max_flatness, double min_spread) {
  return variances(0) < max_flatness * variances(1) && variances(1) > min_spread * variances(2);
}

std::vector<std::size_t> sample_indices(std::size_t count, std::size_t max_samples) {
  const std::size_t every = std::max<std::size_t>(1, count / std::max<std::size_t>(1, max_samples));
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < count; ++i) {
    if (mixed(i) % every == 0) indices.push_back(i);
  }
  return indices;
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

}  // namespace mlo
