#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace mlo {

struct ScanConsistencyOptions {
  double radius_m = 0.5;           ///< of the neighbourhood that makes a plane
  std::size_t min_neighbors = 8;   ///< fewer points are no plane
  std::size_t max_samples = 5000;  ///< of the second scan about this many points are judged
};

/// Distances of points of one scan from the local planes of another.
struct ScanConsistency {
  std::vector<double> residuals_m;  ///< absolute, one for each judged point in a planar neighbourhood

  std::optional<double> median_m() const;
  std::optional<double> mean_m() const;
};

/// How well two scans agree where both see the same surfaces; wrong poses move them apart.
/// @param first, second  points in one frame [m]; those that are not finite are left out
ScanConsistency scan_consistency(std::span<const Eigen::Vector3f> first,
                                 std::span<const Eigen::Vector3f> second,
                                 const ScanConsistencyOptions& options = {});

}  // namespace mlo
