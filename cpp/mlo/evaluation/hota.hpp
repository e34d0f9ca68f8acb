#pragma once

#include <array>
#include <cstddef>

#include "mlo/evaluation/tracking_protocol.hpp"

namespace mlo {

/// Localisation thresholds alpha of HOTA: 0.05, 0.10 ... 0.95.
inline constexpr std::size_t kNumHotaThresholds = 19;

/// Sums for one localisation threshold. Sequences add up.
struct HotaCounts {
  std::size_t true_positives = 0;
  std::size_t false_negatives = 0;
  std::size_t false_positives = 0;
  double association_sum = 0.0;            ///< of TPA / (TPA + FNA + FPA) over true positives
  double association_recall_sum = 0.0;     ///< of TPA / (TPA + FNA)
  double association_precision_sum = 0.0;  ///< of TPA / (TPA + FPA)
  double similarity_sum = 0.0;             ///< over true positives

  HotaCounts& operator+=(const HotaCounts& other);
};

/// Higher order tracking accuracy (Luiten et al., IJCV 2021). Each score is the mean over the thresholds, in
/// [0, 1].
struct Hota {
  std::array<HotaCounts, kNumHotaThresholds> counts;

  Hota& operator+=(const Hota& other);
  double hota() const;  ///< sqrt(DetA AssA)
  double det_a() const;
  double ass_a() const;
  double det_re() const;
  double det_pr() const;
  double ass_re() const;
  double ass_pr() const;
  double loc_a() const;
};

Hota hota(const TrackingSequence& sequence);

}  // namespace mlo
