#include "mlo/evaluation/hota.hpp"

#include <algorithm>
#include <cmath>

#include "mlo/core/assignment.hpp"
#include "mlo/evaluation/measures.hpp"

namespace mlo {
namespace {

using Index = Eigen::Index;
using Matrices = std::array<Eigen::MatrixXd, kNumHotaThresholds>;

Index as_index(std::size_t value) {
  return static_cast<Index>(value);
}

double threshold(std::size_t i) {
  return 0.05 * static_cast<double>(i + 1);
}

// Number of boxes of each true object and of each track.
struct BoxCounts {
  Eigen::VectorXd truth;
  Eigen::RowVectorXd track;
};

BoxCounts count_boxes(const TrackingSequence& sequence) {
  BoxCounts counts{Eigen::VectorXd::Zero(as_index(sequence.num_truth_ids)),
                   Eigen::RowVectorXd::Zero(as_index(sequence.num_track_ids))};
  for (const TrackingFrame& frame : sequence.frames) {
    for (const std::size_t id : frame.truth_ids) counts.truth(as_index(id)) += 1.0;
    for (const std::size_t id : frame.track_ids) counts.track(as_index(id)) += 1.0;
  }
  return counts;
}

// Jaccard index of each true object with each track over the sequence, before any matching: in how much of
// their lives they are alike. What guides the matching of single frames.
Eigen::MatrixXd global_alignment(const TrackingSequence& sequence, const BoxCounts& boxes) {
  Eigen::MatrixXd alike = Eigen::MatrixXd::Zero(boxes.truth.size(), boxes.track.size());
  for (const TrackingFrame& frame : sequence.frames) {
    const Eigen::VectorXd row_sums = frame.similarity.rowwise().sum();
    const Eigen::RowVectorXd col_sums = frame.similarity.colwise().sum();
    for (Index row = 0; row < frame.similarity.rows(); ++row) {
      for (Index col = 0; col < frame.similarity.cols(); ++col) {
        const double similarity = frame.similarity(row, col);
        const double all = row_sums(row) + col_sums(col) - similarity;
        if (all <= kEpsilon) continue;
        alike(as_index(frame.truth_ids[static_cast<std::size_t>(row)]),
              as_index(frame.track_ids[static_cast<std::size_t>(col)])) += similarity / all;
      }
    }
  }
  const Eigen::MatrixXd all =
      boxes.truth.replicate(1, boxes.track.size()) + boxes.track.replicate(boxes.truth.size(), 1) - alike;
  return alike.cwiseQuotient(all);
}

void score_frame(const TrackingFrame& frame, const Eigen::MatrixXd& alignment, Hota& result,
                 Matrices& matches) {
  Eigen::MatrixXd score = frame.similarity;
  for (Index row = 0; row < score.rows(); ++row) {
    for (Index col = 0; col < score.cols(); ++col) {
      score(row, col) *= alignment(as_index(frame.truth_ids[static_cast<std::size_t>(row)]),
                                   as_index(frame.track_ids[static_cast<std::size_t>(col)]));
    }
  }
  const std::vector<Assignment> pairs = optimal_assignment(-score);
  for (std::size_t i = 0; i < kNumHotaThresholds; ++i) {
    std::size_t matched = 0;
    for (const auto& [row, col] : pairs) {
      const double similarity = frame.similarity(row, col);
      if (similarity < threshold(i) - kEpsilon) continue;
      ++matched;
      result.counts[i].similarity_sum += similarity;
      matches[i](as_index(frame.truth_ids[static_cast<std::size_t>(row)]),
                 as_index(frame.track_ids[static_cast<std::size_t>(col)])) += 1.0;
    }
    result.counts[i].true_positives += matched;
    result.counts[i].false_negatives += frame.truth_ids.size() - matched;
    result.counts[i].false_positives += frame.track_ids.size() - matched;
  }
}

void add_associations(const Eigen::MatrixXd& matches, const BoxCounts& boxes, HotaCounts& counts) {
  for (Index col = 0; col < matches.cols(); ++col) {
    for (Index row = 0; row < matches.rows(); ++row) {
      const double shared = matches(row, col);
      if (shared == 0.0) continue;
      counts.association_sum += shared * shared / (boxes.truth(row) + boxes.track(col) - shared);
      counts.association_recall_sum += shared * shared / boxes.truth(row);
      counts.association_precision_sum += shared * shared / boxes.track(col);
    }
  }
}

double detection_accuracy(const HotaCounts& c) {
  return ratio(static_cast<double>(c.true_positives),
               c.true_positives + c.false_negatives + c.false_positives);
}

double association_accuracy(const HotaCounts& c) {
  return ratio(c.association_sum, c.true_positives);
}

template <class Score>
double mean_over_thresholds(const Hota& hota, const Score& score) {
  double sum = 0.0;
  for (const HotaCounts& counts : hota.counts) sum += score(counts);
  return sum / static_cast<double>(kNumHotaThresholds);
}

}  // namespace

HotaCounts& HotaCounts::operator+=(const HotaCounts& other) {
  true_positives += other.true_positives;
  false_negatives += other.false_negatives;
  false_positives += other.false_positives;
  association_sum += other.association_sum;
  association_recall_sum += other.association_recall_sum;
  association_precision_sum += other.association_precision_sum;
  similarity_sum += other.similarity_sum;
  return *this;
}

Hota& Hota::operator+=(const Hota& other) {
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
  return *this;
}

double Hota::hota() const {
  return mean_over_thresholds(
      *this, [](const HotaCounts& c) { return std::sqrt(detection_accuracy(c) * association_accuracy(c)); });
}

double Hota::det_a() const {
  return mean_over_thresholds(*this, detection_accuracy);
}

double Hota::ass_a() const {
  return mean_over_thresholds(*this, association_accuracy);
}

double Hota::det_re() const {
  return mean_over_thresholds(*this, [](const HotaCounts& c) {
    return ratio(static_cast<double>(c.true_positives), c.true_positives + c.false_negatives);
  });
}

double Hota::det_pr() const {
  return mean_over_thresholds(*this, [](const HotaCounts& c) {
    return ratio(static_cast<double>(c.true_positives), c.true_positives + c.false_positives);
  });
}

double Hota::ass_re() const {
  return mean_over_thresholds(
      *this, [](const HotaCounts& c) { return ratio(c.association_recall_sum, c.true_positives); });
}

double Hota::ass_pr() const {
  return mean_over_thresholds(
      *this, [](const HotaCounts& c) { return ratio(c.association_precision_sum, c.true_positives); });
}

double Hota::loc_a() const {
  // As in TrackEval, nothing found is not badly localised: 1 where there are no true positives.
  return mean_over_thresholds(*this, [](const HotaCounts& c) {
    return c.true_positives == 0 ? 1.0 : c.similarity_sum / static_cast<double>(c.true_positives);
  });
}

Hota hota(const TrackingSequence& sequence) {
  Hota result;
  const BoxCounts boxes = count_boxes(sequence);
  const Eigen::MatrixXd alignment = global_alignment(sequence, boxes);
  Matrices matches;
  matches.fill(Eigen::MatrixXd::Zero(boxes.truth.size(), boxes.track.size()));
  for (const TrackingFrame& frame : sequence.frames) score_frame(frame, alignment, result, matches);
  for (std::size_t i = 0; i < kNumHotaThresholds; ++i) add_associations(matches[i], boxes, result.counts[i]);
  return result;
}

}  // namespace mlo
