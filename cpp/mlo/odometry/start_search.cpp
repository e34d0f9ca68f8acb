#include "mlo/odometry/start_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mlo/core/parallel.hpp"
#include "mlo/odometry/thinning.hpp"

namespace mlo {
namespace {

constexpr std::size_t kMaxFeatures = 200;
// Turns that are tried [deg], the likeliest first.
constexpr double kYaws_deg[] = {0.0, -3.0, 3.0};

// The grid, nearest to rest first.
std::vector<SE3> motions(const OdometryConfig& config) {
  const int steps = static_cast<int>(std::floor(config.start_radius_m / config.start_step_m));
  std::vector<SE3> grid;
  for (const double yaw_deg : kYaws_deg) {
    const Eigen::Vector3d rotation(0.0, 0.0, yaw_deg * std::numbers::pi / 180.0);
    for (int x = -steps; x <= steps; ++x) {
      for (int y = -steps; y <= steps; ++y) {
        if (x * x + y * y > steps * steps) continue;
        grid.emplace_back(so3_exp(rotation), config.start_step_m * Eigen::Vector3d(x, y, 0.0));
      }
    }
  }
  std::stable_sort(grid.begin(), grid.end(), [](const SE3& a, const SE3& b) {
    return a.translation().squaredNorm() < b.translation().squaredNorm();
  });
  return grid;
}

// Sum of truncated squared distances of the features to their nearest candidates [m^2].
double cost(const std::vector<FeaturePoint>& features, const CandidateSet& candidates,
            const Placement& placement, double reach_m) {
  double sum = 0.0;
  for (const FeaturePoint& feature : features) {
    const Eigen::Vector3d p = placement(feature);
    const std::optional<std::size_t> nearest = candidates.nearest(p, reach_m);
    sum += nearest ? (candidates.point(*nearest) - p).squaredNorm() : reach_m * reach_m;
  }
  return sum;
}

}  // namespace

SE3 search_start(const EgoFeatures& features, const ReferenceScan& previous, const SweepTiming& timing,
                 const OdometryConfig& config) {
  const std::vector<FeaturePoint> edges = thinned(features.edge, kMaxFeatures);
  const std::vector<FeaturePoint> surfaces = thinned(features.surface, kMaxFeatures);
  const std::vector<SE3> grid = motions(config);
  std::vector<double> costs(grid.size());
  parallel_for_each_index(grid.size(), [&](std::size_t i) {
    const Placement placement(grid[i], timing);
    costs[i] = cost(edges, previous.edge, placement, config.start_step_m) +
               cost(surfaces, previous.surface, placement, config.start_step_m);
  });
  return grid[static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin())];
}

}  // namespace mlo
