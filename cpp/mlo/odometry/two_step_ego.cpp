#include "mlo/odometry/two_step_ego.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "mlo/core/parallel.hpp"
#include "mlo/odometry/matching.hpp"
#include "mlo/odometry/start_search.hpp"
#include "mlo/odometry/thinning.hpp"

namespace mlo {
namespace {

using Active = Eigen::Matrix<bool, 6, 1>;

// Parameters are [t_x t_y t_z roll pitch yaw].
const Active kAll = Active::Constant(true);
const Active kGroundPart = (Active() << false, false, true, true, true, false).finished();
const Active kBackgroundPart = (Active() << true, true, false, false, false, true).finished();

struct Kinds {
  bool ground;
  bool background;
};

struct Matches {
  std::vector<PlaneMatch> ground;
  std::vector<LineMatch> edge;
  std::vector<PlaneMatch> surface;

  std::size_t size() const { return ground.size() + edge.size() + surface.size(); }
};

// Everything an estimate of some of the parameters leaves behind.
struct PartialEstimate {
  SE3 T_previous_current;
  Matches matches;
  NormalEquations sums;
  int degenerate_directions = 0;
  int iterations = 0;
  bool converged = false;
  bool enough_matches = false;
};

class Estimator {
 public:
  Estimator(const EgoFeatures& features, const ReferenceScan& previous, const SweepTiming& timing,
            const OdometryConfig& config)
      : features_(features), previous_(previous), timing_(timing), config_(config) {}

  // Alternates matching, with a gate that narrows, and Gauss-Newton steps, until the pose stays.
  PartialEstimate estimate(const SE3& T_start, Kinds kinds, const Active& active) const {
    PartialEstimate result;
    result.T_previous_current = T_start;
    double gate_m = config_.initial_gate_m;
    for (int i = 0; i < config_.max_matchings; ++i) {
      const SE3 T_matched = result.T_previous_current;
      result.matches = match(T_matched, kinds, gate_m);
      result.enough_matches = result.matches.size() >= static_cast<std::size_t>(config_.min_matches);
      if (!result.enough_matches) return result;
      optimise(active, result);
      if (!result.T_previous_current.is_finite()) {
        result.enough_matches = false;
        return result;
      }
      const bool final_gate = gate_m <= config_.final_gate_m;
      result.converged = final_gate && is_small(T_matched.inverse() * result.T_previous_current, 1.0);
      if (result.converged) return result;
      gate_m = std::max(config_.final_gate_m, gate_m * config_.gate_shrink);
    }
    return result;
  }

 private:
  Matches match(const SE3& T_previous_current, Kinds kinds, double gate_m) const {
    const Placement placement(T_previous_current, timing_);
    Matches matches;
    if (kinds.ground) {
      matches.ground = match_planes(features_.ground, placement, previous_.ground, gate_m, config_);
    }
    if (kinds.background) {
      matches.edge = match_lines(features_.edge, placement, previous_.edge, gate_m, config_);
      matches.surface = match_planes(features_.surface, placement, previous_.surface, gate_m, config_);
    }
    return matches;
  }

  void optimise(const Active& active, PartialEstimate& result) const {
    // A tenth of the motion that asks for new matches: steps below it cannot change the outcome.
    constexpr double kStepShare = 0.1;
    for (int i = 0; i < config_.steps_per_matching; ++i) {
      result.sums = linearize(result.matches, result.T_previous_current);
      const GaussNewtonStep step = solve(result.sums, config_.min_curvature, config_.lever_arm_m, active);
      const SE3 change = SE3::exp(step.xi);
      result.T_previous_current = change * result.T_previous_current;
      result.degenerate_directions = step.degenerate_directions;
      ++result.iterations;
      if (is_small(change, kStepShare)) return;
    }
  }

  NormalEquations linearize(const Matches& matches, const SE3& T_previous_current) const {
    const Placement placement(T_previous_current, timing_);
    const double kernel_squared = config_.kernel_m * config_.kernel_m;
    const auto sum = [&](const auto& kind, const std::vector<FeaturePoint>& features,
                         const auto& residual_of) {
      return parallel_sum<NormalEquations>(kind.size(), [&](NormalEquations& sums, std::size_t i) {
        const FeaturePoint& feature = features[kind[i].feature];
        const auto residual = residual_of(placement(feature), kind[i].shape);
        const double root = kernel_squared / (kernel_squared + residual.value.squaredNorm());
        const double gain = placement.gain(feature);
        for (Eigen::Index row = 0; row < residual.value.size(); ++row)
          sums.add(residual.value(row), gain * residual.jacobian.row(row).transpose(), root * root);
      });
    };
    NormalEquations sums = sum(matches.ground, features_.ground, point_to_plane);
    sums += sum(matches.edge, features_.edge, point_to_line);
    sums += sum(matches.surface, features_.surface, point_to_plane);
    return sums;
  }

  bool is_small(const SE3& motion, double share) const {
    const double max_angle_rad = config_.rematch_angle_deg * std::numbers::pi / 180.0;
    return motion.translation().norm() <= share * config_.rematch_distance_m &&
           motion.rotation_angle_rad() <= share * max_angle_rad;
  }

  const EgoFeatures& features_;
  const ReferenceScan& previous_;
  const SweepTiming timing_;
  const OdometryConfig& config_;
};

// Curvature in the estimated parameters only; the rest is zero.
NormalEquations::Matrix6d block(const NormalEquations::Matrix6d& H, const Active& active) {
  const NormalEquations::Vector6d mask = active.cast<double>();
  return mask.asDiagonal() * H * mask.asDiagonal();
}

// sigma^2 H^-1. Directions with less curvature than a degenerate one get the variance of that limit.
NormalEquations::Matrix6d covariance(const NormalEquations& sums, const OdometryConfig& config) {
  NormalEquations::Vector6d scale = NormalEquations::Vector6d::Ones();
  scale.tail<3>() /= config.lever_arm_m;
  const Eigen::SelfAdjointEigenSolver<NormalEquations::Matrix6d> eigen(scale.asDiagonal() * sums.H *
                                                                       scale.asDiagonal());
  const double variance = sums.cost / std::max(1.0, static_cast<double>(sums.count) - 6.0);
  const NormalEquations::Vector6d floored =
      eigen.eigenvalues().cwiseMax(std::max(config.min_curvature, 1e-9) * sums.weight);
  return variance * scale.asDiagonal() * eigen.eigenvectors() * floored.cwiseInverse().asDiagonal() *
         eigen.eigenvectors().transpose() * scale.asDiagonal();
}

PoseEstimate to_pose_estimate(const PartialEstimate& estimate, const OdometryConfig& config) {
  PoseEstimate pose;
  pose.T_target_source = estimate.T_previous_current;
  pose.degenerate_directions = estimate.degenerate_directions;
  pose.num_matches = estimate.matches.size();
  pose.iterations = estimate.iterations;
  pose.covariance = covariance(estimate.sums, config);
  pose.rms_residual_m = std::sqrt(estimate.sums.cost / std::max(estimate.sums.weight, 1e-12));
  pose.status = EstimateStatus::max_iterations;
  if (estimate.converged) pose.status = EstimateStatus::converged;
  if (estimate.degenerate_directions > 0) pose.status = EstimateStatus::degenerate;
  return pose;
}

// The two steps' sums and counts as if they had been one estimate.
PartialEstimate joined(const PartialEstimate& ground, PartialEstimate background) {
  background.sums.H = block(ground.sums.H, kGroundPart) + block(background.sums.H, kBackgroundPart);
  background.sums.cost += ground.sums.cost;
  background.sums.weight += ground.sums.weight;
  background.sums.count += ground.sums.count;
  background.matches.ground = ground.matches.ground;
  background.degenerate_directions += ground.degenerate_directions;
  background.iterations += ground.iterations;
  background.converged = background.converged && ground.converged;
  return background;
}

EgoFeatures select_features(const Percept& current, const OdometryConfig& config, EgoOdometryResult& result) {
  const auto limit = static_cast<std::size_t>(config.max_features);
  std::vector<FeaturePoint> surface = current.surface.features;
  if (config.estimator == OdometryConfig::Estimator::two_step) {
    std::vector<FeaturePoint> flat;
    std::copy_if(surface.begin(), surface.end(), std::back_inserter(flat), [&](const FeaturePoint& feature) {
      return feature.smoothness <= current.mean_ground_smoothness;
    });
    result.flat_surfaces_scarce = flat.size() < static_cast<std::size_t>(config.min_matches);
    if (!result.flat_surfaces_scarce) surface = std::move(flat);
  }
  return {thinned(current.ground.features, limit), thinned(current.edge.features, limit),
          thinned(surface, limit)};
}

PartialEstimate estimate_increment(const EgoFeatures& features, const ReferenceScan& previous,
                                   const SE3& T_start, const SweepTiming& timing,
                                   const OdometryConfig& config, bool& ground_scarce) {
  const Estimator estimator(features, previous, timing, config);
  if (config.estimator == OdometryConfig::Estimator::two_step) {
    const PartialEstimate ground =
        estimator.estimate(T_start, {.ground = true, .background = false}, kGroundPart);
    ground_scarce = !ground.enough_matches;
    if (!ground_scarce) {
      const PartialEstimate background = estimator.estimate(
          ground.T_previous_current, {.ground = false, .background = true}, kBackgroundPart);
      return joined(ground, background);
    }
  }
  return estimator.estimate(T_start, {.ground = true, .background = true}, kAll);
}

}  // namespace

EgoOdometryResult estimate_ego(const Percept& current, const ReferenceScan& previous,
                               const std::optional<SE3>& guess, const SweepTiming& timing,
                               const OdometryConfig& config, std::size_t frame) {
  EgoOdometryResult result;
  const SE3 T_guess = guess.value_or(SE3());
  EgoFeatures features = select_features(current, config, result);
  const SE3 T_start = guess ? T_guess : search_start(features, previous, timing, config);
  if (config.consistency_check && features.size() > 0) {
    ConsistencyResult checked = check_consistency(features, previous, T_start, timing, config, frame);
    features = std::move(checked.features);
    result.consistency = checked.report;
  }
  const PartialEstimate estimate =
      estimate_increment(features, previous, T_start, timing, config, result.ground_scarce);
  result.num_ground_matches = estimate.matches.ground.size();
  result.num_edge_matches = estimate.matches.edge.size();
  result.num_surface_matches = estimate.matches.surface.size();
  if (estimate.enough_matches) {
    result.increment = to_pose_estimate(estimate, config);
  } else {
    result.increment.T_target_source = T_guess;
    result.increment.status = EstimateStatus::too_few_matches;
    result.increment.num_matches = estimate.matches.size();
  }
  return result;
}

}  // namespace mlo
