#include "mlo/detection/cluster_detector.hpp"

#include <algorithm>

#include "mlo/core/parallel.hpp"
#include "mlo/detection/cell_grid.hpp"
#include "mlo/detection/cluster_model.hpp"
#include "mlo/detection/ground_heights.hpp"
#include "mlo/detection/suppression.hpp"

namespace mlo {
std::vector<Candidate> find_candidates(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                                       const ClusterConfig& config) {
  const GroundHeights ground(points, is_ground, config.reach_m);
  if (ground.empty()) return {};
  const CellGrid grid(points, is_ground, ground, config);
  const std::vector<CellCluster> clusters = cluster_cells(grid, config);
  std::vector<std::vector<Candidate>> by_cluster(clusters.size());
  parallel_for_each_index(
      clusters.size(),
      [&](std::size_t i) { by_cluster[i] = candidates_of(clusters[i], grid, ground, config); }, 8);
  std::vector<Candidate> all;
  for (const std::vector<Candidate>& some : by_cluster) all.insert(all.end(), some.begin(), some.end());
  return all;
}

std::vector<Detection> detect_clusters(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                                       const ClusterConfig& config) {
  std::vector<Detection> likely;
  for (const Candidate& candidate : find_candidates(points, is_ground, config)) {
    const double probability = probability_of(candidate);
    if (probability < config.min_candidate) continue;
    likely.push_back({candidate.object_class, candidate.box, probability});
  }
  return suppress_overlapping(std::move(likely), config.max_shared);
}

}  // namespace mlo
