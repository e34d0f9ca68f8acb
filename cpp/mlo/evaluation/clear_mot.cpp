#include "mlo/evaluation/clear_mot.hpp"

#include <algorithm>
#include <optional>

#include "mlo/core/assignment.hpp"
#include "mlo/evaluation/measures.hpp"

namespace mlo {
namespace {

constexpr double kKeepBonus = 1000.0;  // outweighs any sum of similarities in a frame

// What is remembered of each true object while going through the frames.
struct ObjectState {
  std::size_t frames = 0;
  std::size_t matched_frames = 0;
  std::size_t starts = 0;                       // times that tracking set in
  std::optional<std::size_t> last_track;        // ever
  std::optional<std::size_t> last_frame_track;  // in the last frame that had both truth and tracks
};

std::vector<Assignment> match(const TrackingFrame& frame, const std::vector<ObjectState>& objects,
                              double threshold) {
  Eigen::MatrixXd score = frame.similarity;
  for (Eigen::Index row = 0; row < score.rows(); ++row) {
    const ObjectState& object = objects[frame.truth_ids[static_cast<std::size_t>(row)]];
    for (Eigen::Index col = 0; col < score.cols(); ++col) {
      if (frame.similarity(row, col) < threshold - kEpsilon) {
        score(row, col) = 0.0;
      } else if (object.last_frame_track == frame.track_ids[static_cast<std::size_t>(col)]) {
        score(row, col) += kKeepBonus;
      }
    }
  }
  std::vector<Assignment> pairs = optimal_assignment(-score);
  std::erase_if(pairs, [&](const Assignment& pair) { return score(pair.row, pair.col) <= kEpsilon; });
  return pairs;
}

void score_frame(const TrackingFrame& frame, double threshold, std::vector<ObjectState>& objects,
                 ClearMot& result) {
  for (const std::size_t id : frame.truth_ids) ++objects[id].frames;
  if (frame.truth_ids.empty() || frame.track_ids.empty()) {
    result.false_positives += frame.track_ids.size();
    result.false_negatives += frame.truth_ids.size();
    return;
  }
  const std::vector<Assignment> pairs = match(frame, objects, threshold);
  std::vector<bool> was_tracked;
  for (ObjectState& object : objects) {
    was_tracked.push_back(object.last_frame_track.has_value());
    object.last_frame_track.reset();
  }
  for (const auto& [row, col] : pairs) {
    const std::size_t id = frame.truth_ids[static_cast<std::size_t>(row)];
    const std::size_t track = frame.track_ids[static_cast<std::size_t>(col)];
    ObjectState& object = objects[id];
    if (object.last_track && object.last_track != track) ++result.id_switches;
    if (!was_tracked[id]) ++object.starts;
    object.last_track = object.last_frame_track = track;
    ++object.matched_frames;
    result.similarity_sum += frame.similarity(row, col);
  }
  result.true_positives += pairs.size();
  result.false_negatives += frame.truth_ids.size() - pairs.size();
  result.false_positives += frame.track_ids.size() - pairs.size();
}

}  // namespace

ClearMot& ClearMot::operator+=(const ClearMot& other) {
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

double ClearMot::mota() const {
  const double correct =
      static_cast<double>(true_positives) - static_cast<double>(false_positives + id_switches);
  return ratio(correct, true_positives + false_negatives);
}

double ClearMot::motp() const {
  return ratio(similarity_sum, true_positives);
}

double ClearMot::recall() const {
  return ratio(static_cast<double>(true_positives), true_positives + false_negatives);
}

double ClearMot::precision() const {
  return ratio(static_cast<double>(true_positives), true_positives + false_positives);
}

ClearMot clear_mot(const TrackingSequence& sequence, double match_threshold) {
  ClearMot result;
  std::vector<ObjectState> objects(sequence.num_truth_ids);
  for (const TrackingFrame& frame : sequence.frames) score_frame(frame, match_threshold, objects, result);
  for (const ObjectState& object : objects) {
    const double tracked = ratio(static_cast<double>(object.matched_frames), object.frames);
    if (tracked > kMostlyTracked) {
      ++result.mostly_tracked;
    } else if (tracked >= kMostlyLost) {
      ++result.partly_tracked;
    } else {
      ++result.mostly_lost;
    }
    if (object.starts > 1) result.fragments += object.starts - 1;
  }
  return result;
}

}  // namespace mlo
