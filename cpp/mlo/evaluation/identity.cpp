#include "mlo/evaluation/identity.hpp"

#include <algorithm>

#include "mlo/core/assignment.hpp"

namespace mlo {
namespace {

double share(std::size_t part, double whole) {
  return static_cast<double>(part) / std::max(1.0, whole);
}

}  // namespace

IdentityScore& IdentityScore::operator+=(const IdentityScore& other) {
  true_positives += other.true_positives;
  false_negatives += other.false_negatives;
  false_positives += other.false_positives;
  return *this;
}

double IdentityScore::f1() const {
  return share(true_positives, static_cast<double>(true_positives) +
                                   0.5 * static_cast<double>(false_negatives + false_positives));
}

double IdentityScore::recall() const {
  return share(true_positives, static_cast<double>(true_positives + false_negatives));
}

double IdentityScore::precision() const {
  return share(true_positives, static_cast<double>(true_positives + false_positives));
}

IdentityScore identity_score(const TrackingSequence& sequence, double match_threshold) {
  Eigen::MatrixXd agreeing = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(sequence.num_truth_ids),
                                                   static_cast<Eigen::Index>(sequence.num_track_ids));
  for (const TrackingFrame& frame : sequence.frames) {
    for (Eigen::Index row = 0; row < frame.similarity.rows(); ++row) {
      for (Eigen::Index col = 0; col < frame.similarity.cols(); ++col) {
        if (frame.similarity(row, col) < match_threshold) continue;
        agreeing(static_cast<Eigen::Index>(frame.truth_ids[static_cast<std::size_t>(row)]),
                 static_cast<Eigen::Index>(frame.track_ids[static_cast<std::size_t>(col)])) += 1.0;
      }
    }
  }
  double sum = 0.0;
  for (const auto& [row, col] : optimal_assignment(-agreeing)) sum += agreeing(row, col);
  IdentityScore score;
  score.true_positives = static_cast<std::size_t>(sum);
  score.false_negatives = sequence.num_truth_boxes - score.true_positives;
  score.false_positives = sequence.num_track_boxes - score.true_positives;
  return score;
}

}  // namespace mlo
