#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mlo/evaluation/tracking_protocol.hpp"

namespace mlo {

/// CLEAR MOT as counted by KITTI's own development kit (evaluate_tracking.py), which differs from TrackEval:
/// matches do not favour those of the frame before; matched boxes of ignored truth (vans, truncated ...)
/// count as true positives in MOTP, recall and precision; switches and fragments have other rules. Sequences
/// add up.
struct KitCounts {
  std::size_t truth = 0;            ///< boxes that are not ignored
  std::size_t true_positives = 0;   ///< with those of ignored truth
  std::size_t false_negatives = 0;  ///< without ignored truth
  std::size_t false_positives = 0;
  std::size_t id_switches = 0;
  std::size_t fragments = 0;
  std::size_t mostly_tracked = 0;
  std::size_t partly_tracked = 0;
  std::size_t mostly_lost = 0;
  double similarity_sum = 0.0;  ///< over true positives

  KitCounts& operator+=(const KitCounts& other);
  double mota() const;  ///< 1 - (FN + FP + IDSW) / truth; 0 without truth
  double motp() const;
  double recall() const;
  double precision() const;
};

/// One frame as the kit sees it.
struct KitFrame {
  struct Truth {
    std::size_t id = 0;
    bool ignored = false;
  };
  struct Track {
    std::size_t id = 0;
    bool ignored_if_unmatched = false;
  };
  std::vector<Truth> truth;
  std::vector<Track> tracks;
  Eigen::MatrixXd similarity;  ///< truth (rows) by tracks (columns)
};

struct KitSequence {
  std::vector<KitFrame> frames;
  std::size_t num_truth_ids = 0;
  std::vector<double> track_scores;  ///< mean score of each track over its life, by id
};

/// @throws InputError if an id occurs twice in a frame
KitSequence prepare_kit(std::span<const ObjectRecord> truth, std::span<const ObjectRecord> tracks,
                        const TrackingProtocol& protocol);

/// @param min_track_score  tracks of a lower mean score are left out; none: all are kept
KitCounts count_kit(const KitSequence& sequence, double match_threshold,
                    std::optional<double> min_track_score = std::nullopt);

/// AB3DMOT's measures (Weng et al., IROS 2020): means of the kit's MOTA and MOTP over 40 recall values, each
/// with the tracks that are at least as confident as needed to reach it; sAMOTA scales MOTA by the recall
/// that can be reached.
struct AveragedMot {
  double samota = 0.0;
  double amota = 0.0;
  double amotp = 0.0;
  double best_mota = 0.0;  ///< highest MOTA of those confidences
  std::optional<double>
      best_score;  ///< and the lowest mean score of its tracks; none if MOTA is never above 0
};

AveragedMot averaged_mot(std::span<const KitSequence> sequences, double match_threshold);

}  // namespace mlo
