#pragma once

#include <span>
#include <string>
#include <vector>

#include "mlo/evaluation/clear_mot.hpp"
#include "mlo/evaluation/hota.hpp"
#include "mlo/evaluation/identity.hpp"
#include "mlo/evaluation/kitti_kit.hpp"
#include "mlo/evaluation/tracking_protocol.hpp"

namespace mlo {

/// Truth and tracks of one sequence, of all classes.
struct SequenceRecords {
  std::string name;
  std::vector<ObjectRecord> truth;
  std::vector<ObjectRecord> tracks;
};

/// All measures of the same tracks under the same protocol.
struct TrackingScores {
  ClearMot clear;  ///< TrackEval's counting, as hota and identity
  Hota hota;
  IdentityScore identity;
  KitCounts kit;  ///< the older development kit's counting

  TrackingScores& operator+=(const TrackingScores& other);
};

struct TrackingEvaluation {
  TrackingProtocol protocol;
  std::vector<std::string> names;         ///< of the sequences
  std::vector<TrackingScores> sequences;  ///< one per sequence
  TrackingScores all;                     ///< sequences together
  AveragedMot averaged;                   ///< over confidences, sequences together
};

/// @throws InputError naming the sequence if an id occurs twice in a frame
TrackingEvaluation evaluate_tracking(std::span<const SequenceRecords> sequences,
                                     const TrackingProtocol& protocol);

}  // namespace mlo
