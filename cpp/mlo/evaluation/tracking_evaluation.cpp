#include "mlo/evaluation/tracking_evaluation.hpp"

#include "mlo/core/error.hpp"

namespace mlo {

TrackingScores& TrackingScores::operator+=(const TrackingScores& other) {
  clear += other.clear;
  hota += other.hota;
  identity += other.identity;
  kit += other.kit;
  return *this;
}

TrackingEvaluation evaluate_tracking(std::span<const SequenceRecords> sequences,
                                     const TrackingProtocol& protocol) {
  TrackingEvaluation evaluation{
      .protocol = protocol, .names = {}, .sequences = {}, .all = {}, .averaged = {}};
  std::vector<KitSequence> kit_sequences;
  for (const SequenceRecords& records : sequences) {
    try {
      const TrackingSequence prepared = prepare_tracking(records.truth, records.tracks, protocol);
      kit_sequences.push_back(prepare_kit(records.truth, records.tracks, protocol));
      evaluation.sequences.push_back({.clear = clear_mot(prepared, protocol.match_threshold),
                                      .hota = hota(prepared),
                                      .identity = identity_score(prepared, protocol.match_threshold),
                                      .kit = count_kit(kit_sequences.back(), protocol.match_threshold)});
    } catch (const InputError& error) {
      throw InputError("sequence " + records.name + ", " + error.what());
    }
    evaluation.names.push_back(records.name);
    evaluation.all += evaluation.sequences.back();
  }
  evaluation.averaged = averaged_mot(kit_sequences, protocol.match_threshold);
  return evaluation;
}

}  // namespace mlo
