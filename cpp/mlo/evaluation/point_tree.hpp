#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <nanoflann.hpp>

#include "mlo/core/kd_tree_points.hpp"

// Internal to evaluation: points, their neighbours, and what these look like.
namespace mlo {

using PointCloud = KdTreePoints<std::vector<Eigen::Vector3f>>;

/// PointTree(3, cloud); the cloud must outlive it, not be empty and hold finite points only.
using PointTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PointCloud>,
                                                      PointCloud, 3, std::size_t>;

/// Result set of a radius search that sums up what it is given instead of storing it.
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

  Eigen::Vector3d mean_from_origin() const { return sum_ / static_cast<double>(count_); }
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

/// The sums over the points within a radius.
MomentSum neighbourhood(const PointTree& tree, const PointCloud& cloud, const Eigen::Vector3f& origin,
                        double radius_m);

/// Variances l0 <= l1 <= l2 of a sheet: l0 < max_flatness * l1 (thin) and l1 > min_spread * l2 (not a line).
bool is_sheet(const Eigen::Vector3d& variances, double max_flatness, double min_spread);

/// Some max_samples of count indices, chosen by a hash so that they do not fall into step with the order of
/// points.
std::vector<std::size_t> sample_indices(std::size_t count, std::size_t max_samples);

/// Of at least one value.
double mean(const std::vector<double>& values);
double median(std::vector<double> values);

}  // namespace mlo
