#include "mlo/mapping/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

// A point this near to the map lies on it: less than how far neighbours are looked for, more than what
// distortion and half a step of the grid do.
constexpr float kRankGate_m = 0.5F;
constexpr float kFitGate_m = 0.3F;
constexpr std::size_t kRankPoints = 500;  // of the scan, evenly spread
constexpr std::size_t kRegistered = 12;   // of the starts, best first

struct Start {
  SE3 T_map_lidar;
  double share = 0.0;  // of the points that lie on the map
};

struct Sample {
  Eigen::Vector3d p_lidar;
  const LocalMap* map;
};

std::vector<Sample> sample(std::span<const RefinementTerm> terms, std::size_t count) {
  std::size_t total = 0;
  for (const RefinementTerm& term : terms) total += term.points.size();
  const std::size_t stride = std::max<std::size_t>(1, total / count);
  std::vector<Sample> samples;
  std::size_t i = 0;
  for (const RefinementTerm& term : terms) {
    for (const FeaturePoint& point : term.points) {
      if (i++ % stride == 0) samples.push_back({point.p_lidar.cast<double>(), term.map});
    }
  }
  return samples;
}

// Near points count by how near they are, so that a start between two others is told from them.
double share_on_map(const std::vector<Sample>& samples, const SE3& T_map_lidar, float gate_m) {
  double sum = 0.0;
  for (const Sample& point : samples) {
    const NearestPoints nearest = point.map->nearest((T_map_lidar * point.p_lidar).cast<float>(), 1, gate_m);
    if (nearest.count > 0) {
      sum += 1.0 - static_cast<double>(nearest.squared_distances_m2[0] / (gate_m * gate_m));
    }
  }
  return samples.empty() ? 0.0 : sum / static_cast<double>(samples.size());
}

/// Multiples of a step from -limit to limit.
std::vector<double> steps(double limit, double step) {
  std::vector<double> values;
  const int count = static_cast<int>(std::ceil(limit / step));
  for (int i = -count; i <= count; ++i) values.push_back(i * step);
  return values;
}

std::vector<Start> grid(const SE3& T_map_lidar_guess, const PlaceSearchConfig& config) {
  std::vector<Start> starts;
  for (const double yaw_deg : steps(config.yaw_deg, config.yaw_step_deg)) {
    const Eigen::Quaterniond turn =
        so3_exp({0.0, 0.0, yaw_deg * std::numbers::pi / 180.0}) * T_map_lidar_guess.rotation();
    for (const double x_m : steps(config.radius_m, config.step_m)) {
      for (const double y_m : steps(config.radius_m, config.step_m)) {
        if (std::hypot(x_m, y_m) > config.radius_m + config.step_m) continue;
        starts.push_back({{turn, T_map_lidar_guess.translation() + Eigen::Vector3d(x_m, y_m, 0.0)}});
      }
    }
  }
  return starts;
}

}  // namespace

PoseEstimate find_place(std::span<const RefinementTerm> terms, const SE3& T_map_lidar_guess,
                        const PlaceSearchConfig& search, const RefinementConfig& refinement) {
  const std::vector<Sample> samples = sample(terms, kRankPoints);
  std::vector<Start> starts = grid(T_map_lidar_guess, search);
  parallel_for_each_index(starts.size(), [&](std::size_t i) {
    starts[i].share = share_on_map(samples, starts[i].T_map_lidar, kRankGate_m);
  });
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& a, const Start& b) { return a.share > b.share; });
  starts.resize(std::min(starts.size(), kRegistered));

  PoseEstimate best;
  best.T_target_source = T_map_lidar_guess;
  best.status = EstimateStatus::too_few_matches;
  double best_share = search.min_share;
  for (const Start& start : starts) {
    const RefinementGuess guess{.T_map_lidar_previous = start.T_map_lidar,
                                .T_previous_current = {},
                                .motion_known = false,
                                .timing = {.motion_compensated = true}};
    const PoseEstimate found = refine(terms, guess, refinement);
    const double share = share_on_map(samples, found.T_target_source, kFitGate_m);
    if (!found.usable() || share < best_share) continue;
    best = found;
    best_share = share;
  }
  return best;
}

}  // namespace mlo
