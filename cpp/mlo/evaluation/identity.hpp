#pragma once

#include <cstddef>

#include "mlo/evaluation/tracking_protocol.hpp"

namespace mlo {

/// Identity scores (Ristani et al., ECCVW 2016): each true object is matched to at most one track for its
/// whole life, so that as many boxes as possible agree. Sequences add up.
struct IdentityScore {
  std::size_t true_positives = 0;   ///< IDTP
  std::size_t false_negatives = 0;  ///< IDFN
  std::size_t false_positives = 0;  ///< IDFP

  IdentityScore& operator+=(const IdentityScore& other);
  double f1() const;  ///< IDTP / (IDTP + IDFN / 2 + IDFP / 2); 0 without truth and tracks
  double recall() const;
  double precision() const;
};

IdentityScore identity_score(const TrackingSequence& sequence, double match_threshold = 0.5);

}  // namespace mlo
