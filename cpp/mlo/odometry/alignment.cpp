#include "mlo/odometry/alignment.hpp"

#include <numbers>

#include "mlo/core/parallel.hpp"
#include "mlo/core/robust_kernel.hpp"

namespace mlo {
namespace {

struct Matches {
  std::vector<PlaneMatch> ground;
  std::vector<LineMatch> edge;
  std::vector<PlaneMatch> surface;

  std::size_t size() const { return ground.size() + edge.size() + surface.size(); }
};

class Aligner {
 public:
  Aligner(const EgoFeatures& features, const ReferenceScan& previous, const SweepTiming& timing,
          const OdometryConfig& config)
      : features_(features), previous_(previous), timing_(timing), config_(config) {}

  Matches match(const SE3& T_previous_current, bool ground, bool background) const {
    const Placement placement(T_previous_current, timing_);
    Matches matches;
    if (ground) matches.ground = match_planes(features_.ground, placement, previous_.ground, config_);
    if (background) {
      parallel_invoke(
          [&] { matches.edge = match_lines(features_.edge, placement, previous_.edge, config_); },
          [&] { matches.surface = match_planes(features_.surface, placement, previous_.surface, config_); });
    }
    return matches;
  }

  // Gauss-Newton steps on fixed matches.
  void optimise(const Matches& matches, const AlignmentTask& task, Alignment& alignment) const {
    // A tenth of the motion that asks for new matches: steps below it cannot change the outcome.
    constexpr double kStepShare = 0.1;
    for (int i = 0; i < config_.steps_per_matching; ++i) {
      alignment.sums = linearize(matches, alignment.T_previous_current);
      const GaussNewtonStep step =
          solve(alignment.sums, config_.min_curvature, config_.lever_arm_m, task.active);
      const SE3 change = SE3::exp(step.xi);
      alignment.T_previous_current = change * alignment.T_previous_current;
      alignment.degenerate_directions = step.degenerate_directions;
      ++alignment.iterations;
      if (is_small(change, kStepShare)) return;
    }
  }

  bool is_small(const SE3& motion, double share) const {
    const double max_angle_rad = config_.rematch_angle_deg * std::numbers::pi / 180.0;
    return motion.translation().norm() <= share * config_.rematch_distance_m &&
           motion.rotation_angle_rad() <= share * max_angle_rad;
  }

 private:
  NormalEquations linearize(const Matches& matches, const SE3& T_previous_current) const {
    const Placement placement(T_previous_current, timing_);
    const auto sum = [&](const auto& kind, const std::vector<FeaturePoint>& features,
                         const auto& residual_of) {
      return parallel_sum<NormalEquations>(kind.size(), [&](NormalEquations& sums, std::size_t i) {
        const FeaturePoint& feature = features[kind[i].feature];
        const auto residual = residual_of(placement(feature), kind[i].shape);
        const double weight = geman_mcclure_weight(residual.value.squaredNorm(), config_.kernel_m);
        const double gain = placement.gain(feature);
        for (Eigen::Index row = 0; row < residual.value.size(); ++row)
          sums.add(residual.value(row), gain * residual.jacobian.row(row).transpose(), weight);
      });
    };
    NormalEquations sums = sum(matches.ground, features_.ground, point_to_plane);
    sums += sum(matches.edge, features_.edge, point_to_line);
    sums += sum(matches.surface, features_.surface, point_to_plane);
    return sums;
  }

  const EgoFeatures& features_;
  const ReferenceScan& previous_;
  const SweepTiming timing_;
  const OdometryConfig& config_;
};

}  // namespace

Alignment align(const EgoFeatures& features, const ReferenceScan& previous, const SE3& T_start,
                const SweepTiming& timing, const AlignmentTask& task, const OdometryConfig& config) {
  const Aligner aligner(features, previous, timing, config);
  Alignment alignment;
  alignment.T_previous_current = T_start;
  for (int i = 0; i < config.max_matchings && !alignment.converged; ++i) {
    const SE3 T_matched = alignment.T_previous_current;
    const Matches matches = aligner.match(T_matched, task.ground, task.background);
    alignment.num_ground = matches.ground.size();
    alignment.num_edge = matches.edge.size();
    alignment.num_surface = matches.surface.size();
    alignment.enough_matches = matches.size() >= static_cast<std::size_t>(config.min_matches);
    if (!alignment.enough_matches) break;
    aligner.optimise(matches, task, alignment);
    alignment.enough_matches = alignment.T_previous_current.is_finite();
    if (!alignment.enough_matches) break;
    alignment.converged = aligner.is_small(T_matched.inverse() * alignment.T_previous_current, 1.0);
  }
  return alignment;
}

}  // namespace mlo
