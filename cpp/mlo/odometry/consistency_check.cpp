#include "mlo/odometry/consistency_check.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include "mlo/core/gauss_newton.hpp"
#include "mlo/core/parallel.hpp"
#include "mlo/odometry/matching.hpp"
#include "mlo/odometry/thinning.hpp"

namespace mlo {
namespace {

constexpr std::size_t kBlock = 64;

struct Counts {
  std::size_t ground = 0;
  std::size_t edge = 0;
  std::size_t surface = 0;

  std::size_t background() const { return edge + surface; }
  std::size_t all() const { return ground + edge + surface; }
};

// Matches of the counted features, and the features placed where they were matched.
struct CountedMatches {
  std::vector<LineMatch> edge;
  std::vector<PlaneMatch> ground;
  std::vector<PlaneMatch> surface;
};

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

class Check {
 public:
  Check(const EgoFeatures& features, const ReferenceScan& previous, const SweepTiming& timing,
        const OdometryConfig& config)
      : features_(features),
        previous_(previous),
        timing_(timing),
        config_(config),
        counted_{thinned(features.ground, limit()), thinned(features.edge, limit()),
                 thinned(features.surface, limit())} {}

  const EgoFeatures& counted() const { return counted_; }

  CountedMatches match(const SE3& T_previous_current) const {
    const Placement placement(T_previous_current, timing_);
    CountedMatches matches;
    parallel_invoke(
        [&] { matches.edge = match_lines(counted_.edge, placement, previous_.edge, config_); },
        [&] { matches.ground = match_planes(counted_.ground, placement, previous_.ground, config_); },
        [&] { matches.surface = match_planes(counted_.surface, placement, previous_.surface, config_); });
    return matches;
  }

  // The motion by which a random sample of matches fits: half of it ground, half edges (surfaces where there
  // are not enough edges).
  SE3 sample_motion(const CountedMatches& matches, const SE3& T_matched, std::mt19937_64& random) const {
    const Placement placement(T_matched, timing_);
    NormalEquations sums;
    const auto size = static_cast<std::size_t>(config_.consistency.sample_size);
    const auto draw = [&](const auto& pool, const std::vector<FeaturePoint>& features,
                          const auto& residual_of) {
      for (std::size_t i = 0; i < size && !pool.empty(); ++i) {
        const auto& match = pool[random() % pool.size()];
        const auto residual = residual_of(placement(features[match.feature]), match.shape);
        for (Eigen::Index row = 0; row < residual.value.size(); ++row)
          sums.add(residual.value(row), residual.jacobian.row(row).transpose(), 1.0);
      }
    };
    draw(matches.ground, counted_.ground, point_to_plane);
    if (matches.edge.size() >= size) {
      draw(matches.edge, counted_.edge, point_to_line);
    } else {
      draw(matches.surface, counted_.surface, point_to_plane);
    }
    return SE3::exp(solve(sums, config_.min_curvature, config_.lever_arm_m).xi) * T_matched;
  }

  Counts count(const SE3& T_previous_current) const {
    const Placement placement(T_previous_current, timing_);
    const auto agreeing = [&](const std::vector<FeaturePoint>& features, const CandidateSet& candidates,
                              double max_distance_m) {
      return static_cast<std::size_t>(std::ranges::count_if(features, [&](const FeaturePoint& feature) {
        return agrees(feature, placement, candidates, max_distance_m);
      }));
    };
    const ConsistencyConfig& c = config_.consistency;
    return {agreeing(counted_.ground, previous_.ground, c.ground_max_distance_m),
            agreeing(counted_.edge, previous_.edge, c.max_distance_m),
            agreeing(counted_.surface, previous_.surface, c.max_distance_m)};
  }

  bool passes(const Counts& counts) const {
    const ConsistencyConfig& c = config_.consistency;
    return share(counts.all(), counted_.size()) >= c.min_share &&
           share(counts.ground, counted_.ground.size()) >= c.min_ground_share &&
           share(counts.background(), counted_.edge.size() + counted_.surface.size()) >=
               c.min_background_share;
  }

  EgoFeatures kept(const SE3& T_previous_current) const {
    const Placement placement(T_previous_current, timing_);
    const auto keep = [&](const std::vector<FeaturePoint>& features, const CandidateSet& candidates,
                          double max_distance_m) {
      std::vector<char> agree(features.size());
      parallel_for_each_index(
          features.size(),
          [&](std::size_t i) { agree[i] = agrees(features[i], placement, candidates, max_distance_m); },
          kBlock);
      std::vector<FeaturePoint> result;
      for (std::size_t i = 0; i < features.size(); ++i) {
        if (agree[i]) result.push_back(features[i]);
      }
      return result;
    };
    const ConsistencyConfig& c = config_.consistency;
    return {keep(features_.ground, previous_.ground, c.ground_max_distance_m),
            keep(features_.edge, previous_.edge, c.max_distance_m),
            keep(features_.surface, previous_.surface, c.max_distance_m)};
  }

 private:
  std::size_t limit() const { return static_cast<std::size_t>(config_.consistency.max_counted); }

  bool agrees(const FeaturePoint& feature, const Placement& placement, const CandidateSet& candidates,
              double max_distance_m) const {
    const double range = feature.p_lidar.cast<double>().norm();
    const double reach = max_distance_m + config_.consistency.max_distance_per_range * range;
    return candidates.nearest(placement(feature), reach).has_value();
  }

  const EgoFeatures& features_;
  const ReferenceScan& previous_;
  const SweepTiming timing_;
  const OdometryConfig& config_;
  const EgoFeatures counted_;
};

}  // namespace

ConsistencyResult check_consistency(const EgoFeatures& features, const ReferenceScan& previous,
                                    const SE3& T_previous_current_guess, const SweepTiming& timing,
                                    const OdometryConfig& config, std::size_t frame) {
  const Check check(features, previous, timing, config);
  std::mt19937_64 random(config.consistency.seed + frame);
  ConsistencyResult result;
  SE3 T_best = T_previous_current_guess;
  std::size_t best_count = 0;
  const std::size_t num_counted = check.counted().size();
  const auto min_gain =
      static_cast<std::size_t>(config.consistency.min_gain * static_cast<double>(num_counted));
  const auto judge = [&](const SE3& T_previous_current, const Counts& counts) {
    ++result.report.num_tried;
    const bool better = !result.report.passed || counts.all() > best_count + min_gain;
    if (!better || !check.passes(counts)) return;
    best_count = counts.all();
    T_best = T_previous_current;
    result.report.passed = true;
  };

  judge(T_best, check.count(T_best));
  // Nothing can gain enough once nearly all agree.
  const auto may_gain = [&] { return best_count + min_gain < num_counted; };
  for (int i = 0; i < config.consistency.iterations && may_gain(); i += config.consistency.match_interval) {
    const CountedMatches matches = check.match(T_best);
    std::vector<SE3> motions(static_cast<std::size_t>(
        std::min(config.consistency.match_interval, config.consistency.iterations - i)));
    for (SE3& motion : motions) motion = check.sample_motion(matches, T_best, random);
    std::vector<Counts> counts(motions.size());
    parallel_for_each_index(motions.size(), [&](std::size_t k) { counts[k] = check.count(motions[k]); });
    for (std::size_t k = 0; k < motions.size() && may_gain(); ++k) judge(motions[k], counts[k]);
  }
  result.report.run = true;
  result.report.share = share(best_count, num_counted);
  result.report.num_before = features.size();
  result.T_previous_current = T_best;
  result.features = result.report.passed ? check.kept(T_best) : features;
  result.report.num_after = result.features.size();
  return result;
}

}  // namespace mlo
