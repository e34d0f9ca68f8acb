#pragma once

#include <span>
#include <vector>

#include "mlo/core/assignment.hpp"
#include "mlo/tracking/object_filter.hpp"

namespace mlo {

/// A track or a detection that takes part in an association.
struct AssociationTrack {
  const ObjectFilter* filter = nullptr;
  ObjectClass object_class = ObjectClass::car;
};
struct AssociationDetection {
  const BoxMeasurement* measurement = nullptr;
  ObjectClass object_class = ObjectClass::car;
};

/// True for classes that detectors mix up with each other: they may continue the same track.
bool same_kind(ObjectClass a, ObjectClass b);

/// Gives detections to tracks by position, direction and size (paper, section III-C-2, after Apollo's
/// tracker): distances over their variances, a gate on the position, and the optimal assignment of what is
/// left.
/// @return pairs of a track (row) and a detection (col), in the order of the tracks
std::vector<Assignment> associate(std::span<const AssociationTrack> tracks,
                                  std::span<const AssociationDetection> detections,
                                  const AssociationConfig& config);

}  // namespace mlo
