#include "mlo/evaluation/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <Eigen/SVD>

#include "mlo/evaluation/measures.hpp"

namespace mlo {
namespace {

constexpr double kSpeedBinStep_m_s = 2.0;
constexpr double kMaxBinnedSpeed_m_s = 100.0;

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// For each estimate the index of the truth with the same frame number, or kNone.
std::vector<std::size_t> partners_by_frame(const TrajectoryView& truth, const TrajectoryView& estimate) {
  std::map<std::size_t, std::size_t> index_of_frame;
  for (std::size_t i = 0; i < truth.frames.size(); ++i) index_of_frame.emplace(truth.frames[i], i);
  std::vector<std::size_t> partners(estimate.T_world_body.size(), kNone);
  for (std::size_t i = 0; i < estimate.frames.size(); ++i) {
    const auto found = index_of_frame.find(estimate.frames[i]);
    if (found != index_of_frame.end()) partners[i] = found->second;
  }
  return partners;
}

// For each estimate the index of the truth whose stamp is nearest, or kNone if that is too far away.
std::vector<std::size_t> partners_by_time(const TrajectoryView& truth, const TrajectoryView& estimate,
                                          double max_difference_s) {
  std::multimap<double, std::size_t> index_of_stamp;
  for (std::size_t i = 0; i < truth.stamps_s.size(); ++i) {
    if (std::isfinite(truth.stamps_s[i])) index_of_stamp.emplace(truth.stamps_s[i], i);
  }
  std::vector<std::size_t> partners(estimate.T_world_body.size(), kNone);
  for (std::size_t i = 0; i < estimate.stamps_s.size(); ++i) {
    const double stamp_s = estimate.stamps_s[i];
    double smallest_s = max_difference_s;
    const auto consider = [&](auto candidate) {
      const double difference_s = std::abs(candidate->first - stamp_s);
      if (!(difference_s <= smallest_s)) return;  // also when the estimate's stamp is not a number
      smallest_s = difference_s;
      partners[i] = candidate->second;
    };
    const auto after = index_of_stamp.lower_bound(stamp_s);
    if (after != index_of_stamp.end()) consider(after);
    if (after != index_of_stamp.begin()) consider(std::prev(after));
  }
  return partners;
}

std::optional<double> stamp_of(const TrajectoryView& trajectory, std::size_t index) {
  if (index >= trajectory.stamps_s.size()) return std::nullopt;
  return trajectory.stamps_s[index];
}

// (T_i^-1 T_j)_truth^-1 (T_i^-1 T_j)_estimate
SE3 relative_error(const PosePair& i, const PosePair& j) {
  const SE3 truth = i.T_world_truth.inverse() * j.T_world_truth;
  const SE3 estimate = i.T_world_estimate.inverse() * j.T_world_estimate;
  return truth.inverse() * estimate;
}

std::vector<StepError> step_errors(const PoseMatching& matching) {
  std::vector<StepError> steps;
  for (std::size_t i = 0; i + 1 < matching.pairs.size(); ++i) {
    const PosePair& from = matching.pairs[i];
    const PosePair& to = matching.pairs[i + 1];
    const bool frames_grow = matching.by == MatchBy::frame && to.frame > from.frame;
    const double frames = frames_grow ? static_cast<double>(to.frame - from.frame) : 1.0;
    const SE3 error = relative_error(from, to);
    steps.push_back({.frame = to.frame,
                     .translation_m = error.translation().norm() / frames,
                     .rotation_deg = error.rotation_angle_rad() * kDegPerRad / frames});
  }
  return steps;
}

// Distance travelled along the truth up to each pair.
std::vector<double> truth_distances(std::span<const PosePair> pairs) {
  std::vector<double> distances_m(pairs.size(), 0.0);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const Eigen::Vector3d step =
        pairs[i].T_world_truth.translation() - pairs[i - 1].T_world_truth.translation();
    distances_m[i] = distances_m[i - 1] + step.norm();
  }
  return distances_m;
}

double estimate_path(std::span<const PosePair> pairs) {
  double path_m = 0.0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    path_m += (pairs[i].T_world_estimate.translation() - pairs[i - 1].T_world_estimate.translation()).norm();
  }
  return path_m;
}

struct Segment {
  double length_m = 0.0;
  double speed_m_s = 0.0;
  double translation_percent = 0.0;
  double rotation_deg_per_m = 0.0;
};

double duration_s(const PosePair& from, const PosePair& to, std::size_t steps, double frame_period_s) {
  if (from.time_s && to.time_s && *to.time_s > *from.time_s) return *to.time_s - *from.time_s;
  return static_cast<double>(steps) * frame_period_s;
}

// All sub-paths of the lengths asked for. As in KITTI's kit, one ends at the first pose beyond its length.
std::vector<Segment> all_segments(std::span<const PosePair> pairs, const TrajectoryErrorOptions& options) {
  const std::vector<double> distances_m = truth_distances(pairs);
  const std::size_t step = std::max<std::size_t>(options.segment_step, 1);
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < pairs.size(); i += step) {
    for (const double length_m : options.segment_lengths_m) {
      const auto last = std::upper_bound(distances_m.begin(), distances_m.end(), distances_m[i] + length_m);
      if (last == distances_m.end()) continue;
      const auto j = static_cast<std::size_t>(last - distances_m.begin());
      const SE3 error = relative_error(pairs[i], pairs[j]);
      segments.push_back(
          {.length_m = length_m,
           .speed_m_s = length_m / duration_s(pairs[i], pairs[j], j - i + 1, options.frame_period_s),
           .translation_percent = 100.0 * error.translation().norm() / length_m,
           .rotation_deg_per_m = error.rotation_angle_rad() * kDegPerRad / length_m});
    }
  }
  return segments;
}

template <class Predicate>
SegmentErrors mean_of(const std::vector<Segment>& segments, const Predicate& belongs) {
  SegmentErrors mean;
  for (const Segment& segment : segments) {
    if (!belongs(segment)) continue;
    ++mean.count;
    mean.translation_percent += segment.translation_percent;
    mean.rotation_deg_per_m += segment.rotation_deg_per_m;
  }
  if (mean.count > 0) {
    mean.translation_percent /= static_cast<double>(mean.count);
    mean.rotation_deg_per_m /= static_cast<double>(mean.count);
  }
  return mean;
}

void add_segment_errors(const std::vector<Segment>& segments, const std::vector<double>& lengths_m,
                        TrajectoryErrors& errors) {
  errors.segments = mean_of(segments, [](const Segment&) { return true; });
  for (const double length_m : lengths_m) {
    const auto belongs = [&](const Segment& segment) { return segment.length_m == length_m; };
    errors.by_length.push_back({length_m, mean_of(segments, belongs)});
  }
  for (double speed = kSpeedBinStep_m_s; speed < kMaxBinnedSpeed_m_s; speed += kSpeedBinStep_m_s) {
    const auto belongs = [&](const Segment& s) { return std::abs(s.speed_m_s - speed) < kSpeedBinStep_m_s; };
    const SegmentErrors mean = mean_of(segments, belongs);
    if (mean.count > 0) errors.by_speed.push_back({speed, mean});
  }
}

void add_absolute_errors(std::span<const PosePair> pairs, TrajectoryErrors& errors) {
  errors.T_truth_estimate = align_positions(pairs);
  double sum_squares = 0.0;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d aligned = errors.T_truth_estimate * pair.T_world_estimate.translation();
    const double error_m = (pair.T_world_truth.translation() - aligned).norm();
    errors.position_errors_m.push_back(error_m);
    sum_squares += error_m * error_m;
  }
  if (!pairs.empty()) errors.ate_m = std::sqrt(sum_squares / static_cast<double>(pairs.size()));
}

void add_relative_errors(const PoseMatching& matching, TrajectoryErrors& errors) {
  errors.steps = step_errors(matching);
  if (errors.steps.empty()) return;
  const auto count = static_cast<double>(errors.steps.size());
  double translation_m = 0.0;
  double rotation_deg = 0.0;
  for (const StepError& step : errors.steps) {
    translation_m += step.translation_m;
    rotation_deg += step.rotation_deg;
  }
  errors.rte_m_per_frame = translation_m / count;
  errors.rre_deg_per_frame = rotation_deg / count;
  errors.end_point_error_m =
      relative_error(matching.pairs.front(), matching.pairs.back()).translation().norm();
}

}  // namespace

PoseMatching match_poses(const TrajectoryView& truth, const TrajectoryView& estimate, MatchBy by,
                         double max_time_difference_s) {
  const std::vector<std::size_t> partners = by == MatchBy::frame
                                                ? partners_by_frame(truth, estimate)
                                                : partners_by_time(truth, estimate, max_time_difference_s);
  PoseMatching matching{.by = by, .pairs = {}, .unmatched_truth = 0, .unmatched_estimate = 0};
  std::vector<bool> used(truth.T_world_body.size(), false);
  for (std::size_t i = 0; i < partners.size(); ++i) {
    const std::size_t j = partners[i];
    if (j == kNone || used[j]) continue;
    if (!estimate.T_world_body[i].is_finite() || !truth.T_world_body[j].is_finite()) continue;
    used[j] = true;
    const std::optional<double> truth_time_s = stamp_of(truth, j);
    matching.pairs.push_back({.frame = i < estimate.frames.size() ? estimate.frames[i] : i,
                              .time_s = truth_time_s ? truth_time_s : stamp_of(estimate, i),
                              .T_world_truth = truth.T_world_body[j],
                              .T_world_estimate = estimate.T_world_body[i]});
  }
  matching.unmatched_truth = truth.T_world_body.size() - matching.pairs.size();
  matching.unmatched_estimate = estimate.T_world_body.size() - matching.pairs.size();
  return matching;
}

SE3 align_positions(std::span<const PosePair> pairs) {
  if (pairs.empty()) return {};
  const auto count = static_cast<double>(pairs.size());
  Eigen::Vector3d truth_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimate_mean = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) {
    truth_mean += pair.T_world_truth.translation() / count;
    estimate_mean += pair.T_world_estimate.translation() / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    covariance += (pair.T_world_truth.translation() - truth_mean) *
                  (pair.T_world_estimate.translation() - estimate_mean).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  const Eigen::Matrix3d R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return {Eigen::Quaterniond(R), truth_mean - R * estimate_mean};
}

TrajectoryErrors trajectory_errors(const PoseMatching& matching, const TrajectoryErrorOptions& options) {
  TrajectoryErrors errors;
  errors.num_pairs = matching.pairs.size();
  if (!matching.pairs.empty()) errors.truth_path_m = truth_distances(matching.pairs).back();
  errors.estimate_path_m = estimate_path(matching.pairs);
  add_absolute_errors(matching.pairs, errors);
  add_relative_errors(matching, errors);
  add_segment_errors(all_segments(matching.pairs, options), options.segment_lengths_m, errors);
  return errors;
}

}  // namespace mlo
