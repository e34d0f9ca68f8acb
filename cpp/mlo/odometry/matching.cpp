#include "mlo/odometry/matching.hpp"

#include <algorithm>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

// Neighbours that are looked through where rings are not known.
constexpr std::size_t kNeighborsWithoutRings = 12;
// A triangle's smallest height as a share of the required distance between its corners.
constexpr double kMinTriangleHeight = 0.3;
constexpr std::size_t kGrain = 64;

// The candidate nearest to p on the scan lines within the gap of that of m, but not on it.
template <class Accept>
std::optional<std::size_t> nearest_on_other_rings(const RingQuery& query, std::size_t ring,
                                                  const CandidateSet& candidates,
                                                  const OdometryConfig& config, const Accept& accept) {
  std::optional<std::size_t> best;
  double reach = config.patch_radius_m;
  const auto try_ring = [&](std::size_t other) {
    const std::optional<std::size_t> found = candidates.nearest_on_ring(query, other, reach, accept);
    if (!found) return;
    best = found;
    reach = static_cast<double>((candidates.point(*found).cast<float>() - query.p).norm());
  };
  for (std::size_t gap = 1; gap <= static_cast<std::size_t>(config.max_ring_gap); ++gap) {
    if (ring >= gap) try_ring(ring - gap);
    try_ring(ring + gap);
  }
  return best;
}

std::optional<Plane> plane_without_rings(const Eigen::Vector3d& p, const Eigen::Vector3d& m,
                                         const CandidateSet& candidates, const OdometryConfig& config) {
  const std::vector<std::size_t> near = candidates.nearest(p, kNeighborsWithoutRings, config.patch_radius_m);
  const double min_height = kMinTriangleHeight * config.min_baseline_m;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Eigen::Vector3d n = candidates.point(near[i]);
    if (!line_through(m, n, config.min_baseline_m)) continue;
    for (std::size_t j = i + 1; j < near.size(); ++j) {
      const std::optional<Plane> plane = plane_through(m, n, candidates.point(near[j]), min_height);
      if (plane) return plane;
    }
  }
  return std::nullopt;
}

template <class Shape, class Find>
std::vector<Match<Shape>> match_all(const std::vector<FeaturePoint>& features, const Placement& placement,
                                    const Find& find) {
  std::vector<std::optional<Shape>> found(features.size());
  parallel_for_each_index(
      features.size(), [&](std::size_t i) { found[i] = find(placement(features[i])); }, kGrain);
  std::vector<Match<Shape>> matches;
  matches.reserve(features.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i]) matches.push_back({i, *found[i]});
  }
  return matches;
}

}  // namespace

std::optional<Line> find_line(const Eigen::Vector3d& p, const CandidateSet& candidates,
                              const OdometryConfig& config) {
  const std::optional<std::size_t> nearest = candidates.nearest(p, config.gate_m);
  if (!nearest) return std::nullopt;
  const Eigen::Vector3d m = candidates.point(*nearest);
  if (candidates.ring(*nearest) == Point::kNoRing) {
    for (const std::size_t n : candidates.nearest(p, kNeighborsWithoutRings, config.patch_radius_m)) {
      const std::optional<Line> line = line_through(m, candidates.point(n), config.min_baseline_m);
      if (line) return line;
    }
    return std::nullopt;
  }
  const Eigen::Vector3f m_float = m.cast<float>();
  const auto min_squared = static_cast<float>(config.min_baseline_m * config.min_baseline_m);
  const std::optional<std::size_t> other = nearest_on_other_rings(
      RingQuery(p), candidates.ring(*nearest), candidates, config,
      [&](const Eigen::Vector3f& n) { return (n - m_float).squaredNorm() >= min_squared; });
  if (!other) return std::nullopt;
  return line_through(m, candidates.point(*other), 0.0);
}

std::optional<Plane> find_plane(const Eigen::Vector3d& p, const CandidateSet& candidates,
                                const OdometryConfig& config) {
  const std::optional<std::size_t> nearest = candidates.nearest(p, config.gate_m);
  if (!nearest) return std::nullopt;
  const Eigen::Vector3d m = candidates.point(*nearest);
  const std::size_t ring = candidates.ring(*nearest);
  if (ring == Point::kNoRing) return plane_without_rings(p, m, candidates, config);
  const Eigen::Vector3f m_float = m.cast<float>();
  const auto min_squared = static_cast<float>(config.min_baseline_m * config.min_baseline_m);
  const RingQuery query(p);
  const std::optional<std::size_t> same = candidates.nearest_on_ring(
      query, ring, config.patch_radius_m,
      [&](const Eigen::Vector3f& n) { return (n - m_float).squaredNorm() >= min_squared; });
  if (!same) return std::nullopt;
  const Eigen::Vector3f n = candidates.point(*same).cast<float>();
  const auto min_height = static_cast<float>(kMinTriangleHeight * config.min_baseline_m);
  const Eigen::Vector3f along = (n - m_float).normalized();
  const std::optional<std::size_t> other = nearest_on_other_rings(
      query, ring, candidates, config,
      [&](const Eigen::Vector3f& o) { return (o - m_float).cross(along).norm() >= min_height; });
  if (!other) return std::nullopt;
  return plane_through(m, candidates.point(*same), candidates.point(*other), 0.0);
}

std::vector<LineMatch> match_lines(const std::vector<FeaturePoint>& features, const Placement& placement,
                                   const CandidateSet& candidates, const OdometryConfig& config) {
  return match_all<Line>(features, placement,
                         [&](const Eigen::Vector3d& p) { return find_line(p, candidates, config); });
}

std::vector<PlaneMatch> match_planes(const std::vector<FeaturePoint>& features, const Placement& placement,
                                     const CandidateSet& candidates, const OdometryConfig& config) {
  return match_all<Plane>(features, placement,
                          [&](const Eigen::Vector3d& p) { return find_plane(p, candidates, config); });
}

}  // namespace mlo
