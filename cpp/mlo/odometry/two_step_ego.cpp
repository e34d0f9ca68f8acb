#include "mlo/odometry/two_step_ego.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <Eigen/Eigenvalues>

#include "mlo/odometry/alignment.hpp"
#include "mlo/odometry/start_search.hpp"
#include "mlo/odometry/thinning.hpp"

namespace mlo {
namespace {

using Active = Eigen::Matrix<bool, 6, 1>;

// The two steps of the paper; parameters are [t_x t_y t_z roll pitch yaw].
const AlignmentTask kGroundStep = {.ground = true,
                                   .background = false,
                                   .active = (Active() << false, false, true, true, true, false).finished()};
const AlignmentTask kBackgroundStep = {
    .ground = false,
    .background = true,
    .active = (Active() << true, true, false, false, false, true).finished()};

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

PoseEstimate to_pose_estimate(const Alignment& alignment, const OdometryConfig& config) {
  PoseEstimate pose;
  pose.T_target_source = alignment.T_previous_current;
  pose.degenerate_directions = alignment.degenerate_directions;
  pose.num_matches = alignment.num_matches();
  pose.iterations = alignment.iterations;
  pose.covariance = covariance(alignment.sums, config);
  pose.rms_residual_m = std::sqrt(alignment.sums.cost / std::max(alignment.sums.weight, 1e-12));
  pose.status = EstimateStatus::max_iterations;
  if (alignment.converged) pose.status = EstimateStatus::converged;
  if (alignment.degenerate_directions > 0) pose.status = EstimateStatus::degenerate;
  return pose;
}

// The two steps as if they had been one alignment.
Alignment joined(const Alignment& ground, Alignment background) {
  background.sums.H =
      block(ground.sums.H, kGroundStep.active) + block(background.sums.H, kBackgroundStep.active);
  background.sums.cost += ground.sums.cost;
  background.sums.weight += ground.sums.weight;
  background.sums.count += ground.sums.count;
  background.num_ground = ground.num_ground;
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

Alignment estimate_increment(const EgoFeatures& features, const ReferenceScan& previous, const SE3& T_start,
                             const SweepTiming& timing, const OdometryConfig& config) {
  if (config.estimator == OdometryConfig::Estimator::two_step) {
    const Alignment ground = align(features, previous, T_start, timing, kGroundStep, config);
    if (ground.enough_matches)
      return joined(ground,
                    align(features, previous, ground.T_previous_current, timing, kBackgroundStep, config));
  }
  return align(features, previous, T_start, timing, {}, config);
}

// True where the features do not constrain every direction, judged by one step. Along an open direction the
// check's random motions are arbitrary, and standing still agrees best, because scan lines move with the
// lidar.
bool leaves_direction_open(const EgoFeatures& features, const ReferenceScan& previous, const SE3& T_start,
                           const SweepTiming& timing, const OdometryConfig& config) {
  OdometryConfig one_step = config;
  one_step.max_matchings = 1;
  one_step.steps_per_matching = 1;
  const auto limit = static_cast<std::size_t>(config.consistency.max_counted);
  const EgoFeatures few{thinned(features.ground, limit), thinned(features.edge, limit),
                        thinned(features.surface, limit)};
  return estimate_increment(few, previous, T_start, timing, one_step).degenerate_directions > 0;
}

// Where nothing predicts the motion: a search, then an estimate with a kernel as wide as the step of the
// search. The usual kernel would hold on to the start, or to traffic that moves along.
SE3 find_start(const EgoFeatures& features, const ReferenceScan& previous, const SweepTiming& timing,
               const OdometryConfig& config) {
  OdometryConfig coarse = config;
  coarse.kernel_m = std::max(config.kernel_m, config.start_step_m);
  const SE3 T_start = search_start(features, previous, timing, config);
  const Alignment alignment = estimate_increment(features, previous, T_start, timing, coarse);
  return alignment.enough_matches ? alignment.T_previous_current : T_start;
}

}  // namespace

EgoOdometryResult estimate_ego(const Percept& current, const ReferenceScan& previous,
                               const std::optional<SE3>& guess, const SweepTiming& timing,
                               const OdometryConfig& config, std::size_t frame) {
  EgoOdometryResult result;
  EgoFeatures features = select_features(current, config, result);
  SE3 T_start = guess ? *guess : find_start(features, previous, timing, config);
  if (config.consistency_check && features.size() > 0 &&
      !leaves_direction_open(features, previous, T_start, timing, config)) {
    ConsistencyResult checked = check_consistency(features, previous, T_start, timing, config, frame);
    features = std::move(checked.features);
    T_start = checked.T_previous_current;
    result.consistency = checked.report;
  }
  const Alignment alignment = estimate_increment(features, previous, T_start, timing, config);
  result.num_ground_matches = alignment.num_ground;
  result.num_edge_matches = alignment.num_edge;
  result.num_surface_matches = alignment.num_surface;
  if (alignment.enough_matches) {
    result.increment = to_pose_estimate(alignment, config);
  } else {
    result.increment.T_target_source = guess.value_or(SE3());
    result.increment.status = EstimateStatus::too_few_matches;
    result.increment.num_matches = alignment.num_matches();
  }
  return result;
}

}  // namespace mlo
