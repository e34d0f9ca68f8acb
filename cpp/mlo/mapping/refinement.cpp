#include "mlo/mapping/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <tbb/parallel_sort.h>

#include "mlo/core/parallel.hpp"
#include "mlo/core/robust_kernel.hpp"
#include "mlo/core/voxel_grid.hpp"

namespace mlo {
namespace {

using Vector6d = NormalEquations::Vector6d;

// Rotations count as the motion of a point at this distance when curvatures are compared.
constexpr double kLeverArmM = 10.0;
// Points are sorted by cubes of this side [m].
constexpr float kSortingM = 2.0F;
constexpr std::size_t kGrain = 1024;  // points that are worth a task

// One source point through the iterations. Small, as all of them are gone through in each.
struct Source {
  Eigen::Vector3f p_measured;  // lidar frame at its own time
  float sweep_fraction = 0.0F;
  const RefinementTerm* term = nullptr;
  Eigen::Vector3f searched_map;  // where its neighbours were last searched
  bool searched = false;
  ShapeMatch match;
};

// Grows with x, then y, then z.
std::uint64_t sorting_key(const VoxelKey& key) {
  const auto part = [](int value) { return (static_cast<std::uint64_t>(value) + (1U << 20U)) & 0x1FFFFFU; };
  return part(key.x) << 42U | part(key.y) << 21U | part(key.z);
}

// The points of the terms in the order of the places where they are expected: neighbours in the map come one
// after the other, so that its voxels are still in the cache.
std::vector<Source> collect(std::span<const RefinementTerm> terms, const SE3& T_map_lidar) {
  using Given = std::pair<const RefinementTerm*, const FeaturePoint*>;
  std::vector<Given> given;
  for (const RefinementTerm& term : terms) {
    for (const FeaturePoint& point : term.points) given.emplace_back(&term, &point);
  }
  using Place = std::pair<std::uint64_t, std::size_t>;  // and which of the given is there
  std::vector<Place> places(given.size());
  parallel_for_each_index(
      given.size(),
      [&](std::size_t i) {
        const Eigen::Vector3f p_map = (T_map_lidar * given[i].second->p_lidar.cast<double>()).cast<float>();
        places[i] = {sorting_key(voxel_key(p_map, 1.0F / kSortingM)), i};
      },
      kGrain);
  tbb::parallel_sort(places);
  std::vector<Source> sources(given.size());
  parallel_for_each_index(
      sources.size(),
      [&](std::size_t i) {
        const auto& [term, point] = given[places[i].second];
        sources[i].p_measured = point->p_lidar;
        sources[i].sweep_fraction = point->sweep_fraction;
        sources[i].term = term;
      },
      kGrain);
  return sources;
}

void match(Source& source, const Eigen::Vector3d& p_map, double gate_m, const RefinementConfig& config) {
  const Eigen::Vector3f query = p_map.cast<float>();
  const auto rematch = static_cast<float>(config.rematch_distance_m);
  if (source.searched && (query - source.searched_map).squaredNorm() <= rematch * rematch) return;
  source.searched_map = query;
  source.searched = true;
  const auto neighbours = source.term->map->nearest(query, config.neighbours, static_cast<float>(gate_m));
  source.match = describe(neighbours, source.term->expected, config);
}

// Perturbation at the lidar's origin, axes of the map: p_map = exp(w) arm + t + v with arm = R p_lidar.
void accumulate(const ShapeMatch& match, const Eigen::Vector3d& arm, const Eigen::Vector3d& p_map,
                double gate_m, double kernel_m, NormalEquations& sums) {
  if (match.num_directions == 0) return;
  const double d2 = match.squared_distance_m2(p_map);
  if (!(d2 <= gate_m * gate_m)) return;
  const double robust = geman_mcclure_weight(d2, kernel_m);
  const Eigen::Vector3d d = p_map - match.q_map.cast<double>();
  for (int i = 0; i < match.num_directions; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Eigen::Vector3d n = match.directions[k].cast<double>();
    Vector6d jacobian;
    jacobian.head<3>() = n;
    jacobian.tail<3>() = arm.cross(n);
    sums.add(n.dot(d), jacobian, robust * static_cast<double>(match.weights[k]));
  }
}

SE3 step_from(const SE3& T_map_lidar, const Vector6d& xi) {
  return {so3_exp(xi.tail<3>()) * T_map_lidar.rotation(), T_map_lidar.translation() + xi.head<3>()};
}

NormalEquations::Matrix6d covariance_of(const NormalEquations& sums) {
  // Unobserved directions get a large, finite variance rather than infinity.
  constexpr double kMinInformation = 1e-9;
  const double variance = sums.cost / std::max<double>(1.0, static_cast<double>(sums.count) - 6.0);
  const NormalEquations::Matrix6d H = sums.H + kMinInformation * NormalEquations::Matrix6d::Identity();
  return variance * H.inverse();
}

// The iterations of one registration, with what they share.
class Registration {
 public:
  Registration(std::span<const RefinementTerm> terms, const RefinementGuess& guess,
               const RefinementConfig& config)
      : guess_(guess),
        config_(config),
        sources_(collect(terms, guess.T_map_lidar_previous * guess.T_previous_current)) {}

  PoseEstimate run() {
    PoseEstimate result;
    result.T_target_source = guess_.T_map_lidar_previous * guess_.T_previous_current;
    SE3 T_map_lidar = result.T_target_source;
    const int max_iterations =
        guess_.motion_known ? config_.max_iterations : config_.max_iterations_without_motion;
    double gate_m = guess_.motion_known ? config_.gate_m : config_.gate_without_motion_m;
    auto stride = static_cast<std::size_t>(config_.coarse_stride);
    result.status = EstimateStatus::max_iterations;
    for (int i = 0; i < max_iterations; ++i) {
      const NormalEquations sums = linearize(T_map_lidar, gate_m, stride);
      const std::size_t enough = static_cast<std::size_t>(config_.min_matches) / stride;
      if (sums.count < std::max<std::size_t>(6, enough)) {
        result.status = EstimateStatus::too_few_matches;
        return result;
      }
      const GaussNewtonStep step = solve(sums, config_.min_curvature, kLeverArmM);
      T_map_lidar = step_from(T_map_lidar, step.xi);
      gate_m = std::max(config_.final_gate_m, gate_m * shrink());
      const bool fine = stride == 1;
      const bool settled = gate_m <= config_.final_gate_m && is_small(step.xi, fine ? 1.0 : 20.0);
      report(sums, step, i + 1, result);
      if (settled && fine) {
        result.status = EstimateStatus::converged;
        break;
      }
      if (settled || i >= max_iterations / 2) stride = 1;
    }
    result.T_target_source = T_map_lidar;
    if (result.degenerate_directions > 0) result.status = EstimateStatus::degenerate;
    return result;
  }

 private:
  // Without a motion the gate must stay wide for longer.
  double shrink() const { return guess_.motion_known ? config_.gate_shrink : std::sqrt(config_.gate_shrink); }

  bool is_small(const Vector6d& xi, double factor) const {
    return xi.head<3>().norm() < factor * config_.translation_tolerance_m &&
           xi.tail<3>().norm() < factor * config_.rotation_tolerance_rad;
  }

  static void report(const NormalEquations& sums, const GaussNewtonStep& step, int iterations,
                     PoseEstimate& result) {
    result.covariance = covariance_of(sums);
    result.degenerate_directions = step.degenerate_directions;
    result.num_matches = sums.count;
    result.iterations = iterations;
    result.rms_residual_m = std::sqrt(sums.cost / sums.weight);
  }

  NormalEquations linearize(const SE3& T_map_lidar, double gate_m, std::size_t stride) {
    const SE3 increment = config_.correct_distortion ? guess_.T_map_lidar_previous.inverse() * T_map_lidar
                                                     : guess_.T_previous_current;
    const SweepMotion motion = SweepMotion::from_increment(increment, guess_.timing);
    const double kernel_m = std::max(config_.kernel_m, guess_.motion_known ? 0.0 : gate_m / 3.0);
    const std::size_t count = (sources_.size() + stride - 1) / stride;
    return parallel_sum<NormalEquations>(
        count,
        [&](NormalEquations& sums, std::size_t i) {
          Source& source = sources_[i * stride];
          const Eigen::Vector3d p_lidar =
              motion.undistort(source.p_measured.cast<double>(), static_cast<double>(source.sweep_fraction));
          const Eigen::Vector3d arm = T_map_lidar.rotation() * p_lidar;
          const Eigen::Vector3d p_map = arm + T_map_lidar.translation();
          match(source, p_map, gate_m, config_);
          accumulate(source.match, arm, p_map, gate_m, kernel_m, sums);
        },
        128);
  }

  const RefinementGuess& guess_;
  const RefinementConfig& config_;
  std::vector<Source> sources_;
};

}  // namespace

PoseEstimate refine(std::span<const RefinementTerm> terms, const RefinementGuess& guess,
                    const RefinementConfig& config) {
  return Registration(terms, guess, config).run();
}

}  // namespace mlo
