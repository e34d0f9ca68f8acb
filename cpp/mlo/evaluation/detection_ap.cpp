#include "mlo/evaluation/detection_ap.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

#include <Eigen/Core>

#include "mlo/core/box_overlap.hpp"
#include "mlo/evaluation/measures.hpp"
#include "mlo/evaluation/tracking_protocol.hpp"

namespace mlo {
namespace {

using Index = Eigen::Index;

struct Limits {
  double min_height_px;
  int max_occlusion;
  int max_truncation;
};

// KITTI's object labels give truncation as a share (at most 0.15, 0.3, 0.5), its tracking labels as a level.
constexpr Limits limits_of(Difficulty difficulty) {
  switch (difficulty) {
    case Difficulty::easy:
      return {40.0, 0, 0};
    case Difficulty::moderate:
      return {25.0, 1, 1};
    case Difficulty::hard:
      break;
  }
  return {25.0, 2, 1};
}

enum class Role { counts, ignored };

// What takes part of one frame, in the order given.
struct Candidates {
  std::vector<Role> truth_roles;
  std::vector<Role> detection_roles;
  std::vector<double> ranges_m;  // of the truth
  std::vector<double> confidences;
  Eigen::MatrixXd overlap;  // truth (rows) by detections (columns)
};

Role role_of(const LabelledBox& truth, const std::string& object_class, const Limits& limits) {
  const bool demanded = truth.type == object_class && truth.height_px >= limits.min_height_px &&
                        truth.occlusion <= limits.max_occlusion && truth.truncation <= limits.max_truncation;
  return demanded ? Role::counts : Role::ignored;
}

Candidates prepare(const DetectionFrame& frame, const DetectionProtocol& protocol, Difficulty difficulty) {
  const Limits limits = limits_of(difficulty);
  const std::vector<std::string> neighbors = neighbors_of(protocol.object_class);
  Candidates candidates;
  std::vector<const Box3d*> truth;
  std::vector<const Box3d*> detections;
  for (const LabelledBox& label : frame.truth) {
    if (label.type != protocol.object_class && std::ranges::find(neighbors, label.type) == neighbors.end())
      continue;
    truth.push_back(&label.box);
    candidates.truth_roles.push_back(role_of(label, protocol.object_class, limits));
    candidates.ranges_m.push_back(label.box.center_lidar_m.head<2>().norm());
  }
  for (const ScoredBox& detection : frame.detections) {
    if (detection.type != protocol.object_class) continue;
    detections.push_back(&detection.box);
    const bool counts = detection.height_px >= limits.min_height_px;
    candidates.detection_roles.push_back(counts ? Role::counts : Role::ignored);
    candidates.confidences.push_back(detection.confidence);
  }
  candidates.overlap.resize(static_cast<Index>(truth.size()), static_cast<Index>(detections.size()));
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < detections.size(); ++j) {
      candidates.overlap(static_cast<Index>(i), static_cast<Index>(j)) =
          protocol.overlap == BoxOverlap::volume ? intersection_over_union(*truth[i], *detections[j])
                                                 : footprint_iou(*truth[i], *detections[j]);
    }
  }
  return candidates;
}

std::vector<Candidates> prepare_all(std::span<const DetectionFrame> frames, const DetectionProtocol& protocol,
                                    Difficulty difficulty) {
  std::vector<Candidates> all;
  for (const DetectionFrame& frame : frames) all.push_back(prepare(frame, protocol, difficulty));
  return all;
}

// Which of the detections that may match is preferred: the kit takes the most confident one while it looks
// for thresholds, and the one that overlaps most while it counts.
enum class Prefer { confidence, overlap };

struct Counts {
  std::size_t true_positives = 0;
  std::size_t false_positives = 0;
  std::vector<double> confidences;     // of the true positives
  std::vector<double> found_ranges_m;  // of the truth they match
};

std::optional<std::size_t> best_match(const Candidates& frame, std::size_t truth,
                                      const std::vector<bool>& taken, double min_overlap,
                                      double min_confidence, Prefer prefer) {
  std::optional<std::size_t> best;
  const auto better = [&](std::size_t j) {
    if (!best) return true;
    if (prefer == Prefer::confidence) return frame.confidences[j] > frame.confidences[*best];
    if (frame.detection_roles[j] != frame.detection_roles[*best])
      return frame.detection_roles[j] == Role::counts;
    // among those that are not counted the kit keeps the first
    return frame.detection_roles[j] == Role::counts &&
           frame.overlap(static_cast<Index>(truth), static_cast<Index>(j)) >
               frame.overlap(static_cast<Index>(truth), static_cast<Index>(*best));
  };
  for (std::size_t j = 0; j < frame.confidences.size(); ++j) {
    if (taken[j] || frame.confidences[j] < min_confidence) continue;
    if (frame.overlap(static_cast<Index>(truth), static_cast<Index>(j)) > min_overlap && better(j)) best = j;
  }
  return best;
}

void count_frame(const Candidates& frame, double min_overlap, double min_confidence, Prefer prefer,
                 Counts& counts) {
  std::vector<bool> taken(frame.confidences.size(), false);
  for (std::size_t i = 0; i < frame.truth_roles.size(); ++i) {
    const auto match = best_match(frame, i, taken, min_overlap, min_confidence, prefer);
    if (!match) continue;
    taken[*match] = true;
    if (frame.truth_roles[i] == Role::ignored || frame.detection_roles[*match] == Role::ignored) continue;
    ++counts.true_positives;
    counts.confidences.push_back(frame.confidences[*match]);
    counts.found_ranges_m.push_back(frame.ranges_m[i]);
  }
  for (std::size_t j = 0; j < taken.size(); ++j) {
    const bool counted =
        !taken[j] && frame.detection_roles[j] == Role::counts && frame.confidences[j] >= min_confidence;
    if (counted) ++counts.false_positives;
  }
}

Counts count(const std::vector<Candidates>& frames, double min_overlap, double min_confidence,
             Prefer prefer) {
  Counts counts;
  for (const Candidates& frame : frames) {
    count_frame(frame, min_overlap, min_confidence, prefer, counts);
  }
  return counts;
}

std::size_t demanded(const std::vector<Candidates>& frames) {
  std::size_t sum = 0;
  for (const Candidates& frame : frames) {
    sum += static_cast<std::size_t>(std::ranges::count(frame.truth_roles, Role::counts));
  }
  return sum;
}

// The confidences at which the recall is nearest to 0, 1/40, 2/40 ...; as many as are reached.
std::vector<double> thresholds(std::vector<double> confidences, std::size_t num_truth) {
  std::ranges::sort(confidences, std::greater());
  std::vector<double> chosen;
  double wanted = 0.0;
  for (std::size_t i = 0; i < confidences.size(); ++i) {
    const bool last = i + 1 == confidences.size();
    const double here = static_cast<double>(i + 1) / static_cast<double>(num_truth);
    const double next = last ? here : static_cast<double>(i + 2) / static_cast<double>(num_truth);
    if (next - wanted < wanted - here && !last) continue;
    chosen.push_back(confidences[i]);
    wanted += 1.0 / static_cast<double>(AveragePrecision::kRecallPoints);
  }
  return chosen;
}

}  // namespace

AveragePrecision average_precision(std::span<const DetectionFrame> frames, const DetectionProtocol& protocol,
                                   Difficulty difficulty) {
  constexpr std::size_t kPoints = AveragePrecision::kRecallPoints;
  constexpr double kAnyConfidence = std::numeric_limits<double>::lowest();
  const std::vector<Candidates> prepared = prepare_all(frames, protocol, difficulty);
  AveragePrecision result;
  result.num_truth = demanded(prepared);
  if (result.num_truth == 0) return result;
  const Counts all = count(prepared, protocol.min_overlap, kAnyConfidence, Prefer::confidence);
  result.recall = ratio(static_cast<double>(all.true_positives), result.num_truth);
  // the first of the thresholds stands for recall 0, which the mean leaves out
  std::array<double, kPoints + 1> precision = {};
  const std::vector<double> levels = thresholds(all.confidences, result.num_truth);
  for (std::size_t i = 0; i < std::min(levels.size(), precision.size()); ++i) {
    const Counts counts = count(prepared, protocol.min_overlap, levels[i], Prefer::overlap);
    precision[i] =
        ratio(static_cast<double>(counts.true_positives), counts.true_positives + counts.false_positives);
  }
  for (std::size_t i = kPoints; i > 0; --i) precision[i - 1] = std::max(precision[i - 1], precision[i]);
  std::copy(precision.begin() + 1, precision.end(), result.precision.begin());
  result.ap = std::accumulate(result.precision.begin(), result.precision.end(), 0.0) / kPoints;
  return result;
}

std::vector<RangeRecall> recall_by_range(std::span<const DetectionFrame> frames,
                                         const DetectionProtocol& protocol, Difficulty difficulty,
                                         std::span<const double> borders_m, double min_confidence) {
  const std::vector<Candidates> prepared = prepare_all(frames, protocol, difficulty);
  const Counts counts = count(prepared, protocol.min_overlap, min_confidence, Prefer::overlap);
  std::vector<RangeRecall> bins;
  for (std::size_t i = 0; i + 1 < borders_m.size(); ++i) {
    RangeRecall bin{borders_m[i], borders_m[i + 1]};
    const auto is_inside = [&](double range_m) { return range_m >= bin.from_m && range_m < bin.to_m; };
    for (const Candidates& frame : prepared) {
      for (std::size_t k = 0; k < frame.ranges_m.size(); ++k) {
        if (frame.truth_roles[k] == Role::counts && is_inside(frame.ranges_m[k])) ++bin.truth;
      }
    }
    bin.found = static_cast<std::size_t>(std::ranges::count_if(counts.found_ranges_m, is_inside));
    bins.push_back(bin);
  }
  return bins;
}

}  // namespace mlo
