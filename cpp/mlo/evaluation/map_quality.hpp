#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include <Eigen/Core>

namespace mlo {

struct MapQualityOptions {
  double radius_m = 0.5;           ///< of the ball around a point that is its neighbourhood
  std::size_t min_neighbors = 10;  ///< fewer points in the ball, itself included, say nothing
  std::size_t max_samples =
      20000;  ///< of a larger cloud about this many points are judged, against all points
  /// A neighbourhood is planar if it is a sheet: its eigenvalues l0 <= l1 <= l2 (variances) satisfy l0 <
  /// max_flatness
  /// * l1 (thin) and l1 > min_spread * l2 (not a line).
  double max_flatness = 0.1;
  double min_spread = 0.1;
  /// Added to every direction's standard deviation squared: duplicates and exact planes keep a finite
  /// entropy.
  double sigma_floor_m = 0.001;
};

/// How sharp a map is, without any truth: surfaces seen from wrong poses get thick. Comparable between maps
/// of the same scans, made with the same options; lower is better.
struct MapQuality {
  std::size_t num_points = 0;                     ///< finite ones
  std::size_t num_samples = 0;                    ///< judged points with enough neighbours
  std::size_t num_planar = 0;                     ///< of these, those in a planar neighbourhood
  std::optional<double> plane_residual_mean_m;    ///< mean of sqrt(l0) over planar neighbourhoods
  std::optional<double> plane_residual_median_m;  ///< median of the same
  /// Mean map entropy: mean of 0.5 ln |2 pi e Sigma| over the samples, Sigma the neighbourhood's covariance
  /// [m^2] (Droeschel and Behnke, ICRA 2018; Razlaw et al., ECMR 2015).
  std::optional<double> mean_entropy;
};

/// @param points  accumulated points in one frame [m]; points that are not finite are left out
MapQuality map_quality(std::span<const Eigen::Vector3f> points, const MapQualityOptions& options = {});

}  // namespace mlo
