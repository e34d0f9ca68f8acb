#pragma once

#include <cstddef>

#include "mlo/evaluation/tracking_protocol.hpp"

namespace mlo {

/// Counts of CLEAR MOT (Bernardin and Stiefelhagen, 2008) with TrackEval's rules. Sequences add up.
struct ClearMot {
  std::size_t true_positives = 0;
  std::size_t false_negatives = 0;
  std::size_t false_positives = 0;
  std::size_t id_switches = 0;     ///< matches to another track than the last one of this true object
  std::size_t fragments = 0;       ///< times that the tracking of a true object sets in again
  std::size_t mostly_tracked = 0;  ///< true objects matched in more than 80 % of their frames
  std::size_t partly_tracked = 0;  ///< the others, down to 20 %
  std::size_t mostly_lost = 0;     ///< less
  double similarity_sum = 0.0;     ///< over true positives

  ClearMot& operator+=(const ClearMot& other);
  double mota() const;  ///< (TP - FP - IDSW) / (TP + FN), at most 1; 0 without truth and tracks
  double motp() const;  ///< mean similarity of true positives; 0 without any
  double recall() const;
  double precision() const;
};

/// Matches frame by frame: first keeps matches of the frame before, then maximises similarity.
ClearMot clear_mot(const TrackingSequence& sequence, double match_threshold = 0.5);

}  // namespace mlo
