#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "mlo/odometry/config.hpp"
#include "mlo/odometry/placement.hpp"
#include "mlo/odometry/reference_scan.hpp"
#include "mlo/odometry/residuals.hpp"

namespace mlo {

/// A feature and the line or plane of the previous scan that it lies on.
template <class Shape>
struct Match {
  std::size_t feature = 0;  ///< index into the features that were matched
  Shape shape;
};
using LineMatch = Match<Line>;
using PlaneMatch = Match<Plane>;

/// The line for a point in the previous lidar frame: through its nearest candidate m and a candidate n of
/// another scan line (LOAM). Where rings are not known: through m and its nearest neighbour that is far
/// enough.
std::optional<Line> find_line(const Eigen::Vector3d& p, const CandidateSet& candidates, double gate_m,
                              const OdometryConfig& config);

/// The plane for a point: through its nearest candidate m, n of the same scan line and o of another one.
/// Where rings are not known: through m and near neighbours that span a triangle.
std::optional<Plane> find_plane(const Eigen::Vector3d& p, const CandidateSet& candidates, double gate_m,
                                const OdometryConfig& config);

/// Matches of all features, in their order.
/// @param gate_m  farthest nearest candidate [m]
std::vector<LineMatch> match_lines(const std::vector<FeaturePoint>& features, const Placement& placement,
                                   const CandidateSet& candidates, double gate_m,
                                   const OdometryConfig& config);
std::vector<PlaneMatch> match_planes(const std::vector<FeaturePoint>& features, const Placement& placement,
                                     const CandidateSet& candidates, double gate_m,
                                     const OdometryConfig& config);

}  // namespace mlo
