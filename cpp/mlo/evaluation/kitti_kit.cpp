#include "mlo/evaluation/kitti_kit.hpp"

#include <algorithm>
#include <functional>
#include <map>

#include "mlo/core/assignment.hpp"
#include "mlo/evaluation/measures.hpp"

namespace mlo {
namespace {

constexpr double kNeverMatch = 1e6;  // more than the costs of a frame's matches together
constexpr std::size_t kRecallSteps = 40;

std::vector<std::string> kit_neighbors(const std::string& object_class) {
  if (object_class == "car") return {"van"};
  if (object_class == "pedestrian") return {"person_sitting"};
  return {};
}

// A true object in one of the frames that it is in.
struct Sighting {
  std::optional<std::size_t> track;
  bool ignored = false;
};
using Trajectory = std::vector<Sighting>;

std::vector<std::size_t> kept_tracks(const KitFrame& frame, const KitSequence& sequence,
                                     std::optional<double> min_track_score) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < frame.tracks.size(); ++i) {
    if (!min_track_score || sequence.track_scores[frame.tracks[i].id] >= *min_track_score) kept.push_back(i);
  }
  return kept;
}

std::vector<Assignment> match(const Eigen::MatrixXd& similarity, double threshold) {
  const Eigen::MatrixXd cost =
      (similarity.array() >= threshold).select(1.0 - similarity.array(), kNeverMatch);
  std::vector<Assignment> pairs = optimal_assignment(cost);
  std::erase_if(pairs, [&](const Assignment& pair) { return similarity(pair.row, pair.col) < threshold; });
  return pairs;
}

void count_frame(const KitFrame& frame, const std::vector<std::size_t>& kept, double threshold,
                 KitCounts& counts, std::vector<Trajectory>& trajectories) {
  std::vector<std::optional<std::size_t>> partner(frame.truth.size());
  std::vector<bool> matched(frame.tracks.size(), false);
  const Eigen::MatrixXd similarity = frame.similarity(Eigen::all, kept);
  for (const auto& [row, col] : match(similarity, threshold)) {
    const std::size_t track = kept[static_cast<std::size_t>(col)];
    partner[static_cast<std::size_t>(row)] = frame.tracks[track].id;
    matched[track] = true;
    counts.similarity_sum += similarity(row, col);
    ++counts.true_positives;
  }
  for (std::size_t i = 0; i < frame.truth.size(); ++i) {
    const bool ignored = frame.truth[i].ignored;
    trajectories[frame.truth[i].id].push_back({partner[i], ignored});
    if (ignored) continue;
    ++counts.truth;
    if (!partner[i]) ++counts.false_negatives;
  }
  for (const std::size_t i : kept) {
    if (!matched[i] && !frame.tracks[i].ignored_if_unmatched) ++counts.false_positives;
  }
}

// Goes along one true object's life by the kit's rules, odd ones included: the last frame can begin a
// fragment without a frame after it, other frames cannot; a match in an ignored first frame counts as
// tracked.
void count_trajectory(const Trajectory& g, KitCounts& counts) {
  const auto ignored =
      static_cast<std::size_t>(std::count_if(g.begin(), g.end(), std::mem_fn(&Sighting::ignored)));
  if (g.empty() || ignored == g.size()) return;
  std::optional<std::size_t> last = g.front().track;
  std::size_t tracked = last ? 1 : 0;
  for (std::size_t f = 1; f < g.size(); ++f) {
    if (g[f].ignored) {
      last.reset();
      continue;
    }
    if (!g[f].track) continue;
    ++tracked;
    if (last && g[f - 1].track && last != g[f].track) ++counts.id_switches;
    const bool changed = g[f - 1].track != g[f].track;
    const bool is_last = f + 1 == g.size();
    if (changed && (is_last || (last && g[f + 1].track))) ++counts.fragments;
    last = g[f].track;
  }
  const double share = ratio(static_cast<double>(tracked), g.size() - ignored);
  if (share > kMostlyTracked) {
    ++counts.mostly_tracked;
  } else if (share < kMostlyLost) {
    ++counts.mostly_lost;
  } else {
    ++counts.partly_tracked;
  }
}

KitCounts count_all(std::span<const KitSequence> sequences, double threshold,
                    std::optional<double> min_track_score) {
  KitCounts counts;
  for (const KitSequence& sequence : sequences) counts += count_kit(sequence, threshold, min_track_score);
  return counts;
}

// Mean scores of the tracks of all true positives, best first.
std::vector<double> true_positive_scores(std::span<const KitSequence> sequences, double threshold) {
  std::vector<double> scores;
  for (const KitSequence& sequence : sequences) {
    for (const KitFrame& frame : sequence.frames) {
      for (const auto& [row, col] : match(frame.similarity, threshold)) {
        scores.push_back(sequence.track_scores[frame.tracks[static_cast<std::size_t>(col)].id]);
      }
    }
  }
  std::sort(scores.begin(), scores.end(), std::greater<>());
  return scores;
}

struct RecallPoint {
  double recall = 0.0;
  double min_score = 0.0;
};

// The scores at which recall comes nearest to 1/40, 2/40 ...
std::vector<RecallPoint> recall_points(const std::vector<double>& scores, std::size_t num_truth) {
  std::vector<RecallPoint> points;
  double recall = 0.0;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const bool is_last = i + 1 == scores.size();
    const double here = ratio(static_cast<double>(i + 1), num_truth);
    const double next = is_last ? here : ratio(static_cast<double>(i + 2), num_truth);
    if (!is_last && next - recall < recall - here) continue;
    points.push_back({recall, scores[i]});
    recall += 1.0 / static_cast<double>(kRecallSteps);
  }
  if (!points.empty()) points.erase(points.begin());  // recall 0
  return points;
}

double scaled_mota(const KitCounts& counts, double recall) {
  const auto truth = static_cast<double>(counts.truth);
  const auto errors =
      static_cast<double>(counts.false_negatives + counts.false_positives + counts.id_switches);
  if (truth == 0.0) return 0.0;
  return std::clamp(1.0 - (errors - (1.0 - recall) * truth) / (recall * truth), 0.0, 1.0);
}

}  // namespace

KitCounts& KitCounts::operator+=(const KitCounts& other) {
  truth += other.truth;
  true_positives += other.true_positives;
  false_negatives += other.false_negatives;
  false_positives += other.false_positives;
  id_switches += other.id_switches;
  fragments += other.fragments;
  mostly_tracked += other.mostly_tracked;
  partly_tracked += other.partly_tracked;
  mostly_lost += other.mostly_lost;
  similarity_sum += other.similarity_sum;
  return *this;
}

double KitCounts::mota() const {
  if (truth == 0) return 0.0;
  return 1.0 - ratio(static_cast<double>(false_negatives + false_positives + id_switches), truth);
}

double KitCounts::motp() const {
  return ratio(similarity_sum, true_positives);
}

double KitCounts::recall() const {
  return ratio(static_cast<double>(true_positives), true_positives + false_negatives);
}

double KitCounts::precision() const {
  return ratio(static_cast<double>(true_positives), true_positives + false_positives);
}

KitSequence prepare_kit(std::span<const ObjectRecord> truth, std::span<const ObjectRecord> tracks,
                        const TrackingProtocol& protocol) {
  KitSequence sequence;
  std::map<long, std::size_t> truth_numbers;
  std::map<long, std::size_t> track_numbers;
  std::vector<std::size_t> track_boxes;
  const std::vector<std::string> neighbors = kit_neighbors(protocol.object_class);
  for (const RecordFrame& records : group_by_frame(truth, tracks, protocol.object_class, neighbors)) {
    KitFrame frame;
    for (const ObjectRecord* record : records.truth) {
      const std::size_t id = truth_numbers.emplace(record->track_id, truth_numbers.size()).first->second;
      frame.truth.push_back({id, is_ignored(*record, protocol)});
    }
    for (const ObjectRecord* record : records.tracks) {
      const std::size_t id = track_numbers.emplace(record->track_id, track_numbers.size()).first->second;
      const bool neighbor = record->type != protocol.object_class;
      frame.tracks.push_back({id, neighbor || is_excused(*record, records.dont_care, protocol)});
      sequence.track_scores.resize(track_numbers.size(), 0.0);
      track_boxes.resize(track_numbers.size(), 0);
      sequence.track_scores[id] += record->score;
      ++track_boxes[id];
    }
    frame.similarity = similarities(records, protocol);
    sequence.frames.push_back(std::move(frame));
  }
  sequence.num_truth_ids = truth_numbers.size();
  for (std::size_t i = 0; i < track_boxes.size(); ++i)
    sequence.track_scores[i] /= static_cast<double>(track_boxes[i]);
  return sequence;
}

KitCounts count_kit(const KitSequence& sequence, double match_threshold,
                    std::optional<double> min_track_score) {
  KitCounts counts;
  std::vector<Trajectory> trajectories(sequence.num_truth_ids);
  for (const KitFrame& frame : sequence.frames) {
    count_frame(frame, kept_tracks(frame, sequence, min_track_score), match_threshold, counts, trajectories);
  }
  for (const Trajectory& trajectory : trajectories) count_trajectory(trajectory, counts);
  return counts;
}

AveragedMot averaged_mot(std::span<const KitSequence> sequences, double match_threshold) {
  const KitCounts all = count_all(sequences, match_threshold, std::nullopt);
  const std::vector<double> scores = true_positive_scores(sequences, match_threshold);
  AveragedMot result;
  for (const RecallPoint& point : recall_points(scores, all.true_positives + all.false_negatives)) {
    const KitCounts counts = count_all(sequences, match_threshold, point.min_score);
    result.samota += scaled_mota(counts, point.recall) / static_cast<double>(kRecallSteps);
    result.amota += counts.mota() / static_cast<double>(kRecallSteps);
    result.amotp += counts.motp() / static_cast<double>(kRecallSteps);
    if (counts.mota() > result.best_mota) {
      result.best_mota = counts.mota();
      result.best_score = point.min_score;
    }
  }
  return result;
}

}  // namespace mlo
