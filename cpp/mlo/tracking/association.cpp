#include "mlo/tracking/association.hpp"

#include <algorithm>
#include <cmath>

namespace mlo {
namespace {

constexpr double kNever = 1e6;
constexpr double kMaxTerm = 9.0;  // of size and heading: they tell neighbours apart, and must not veto

/// What a pair costs: below zero for a likely one, 0 at the gate, kNever beyond.
double pair_cost(const AssociationTrack& track, const AssociationDetection& detection,
                 const AssociationConfig& config) {
  if (!same_kind(track.object_class, detection.object_class)) return kNever;
  const double extra_sd_m = config.partial_view * detection.measurement->box.size_lwh_m.x();
  const ObjectFilter::Distance apart = track.filter->distance(*detection.measurement, extra_sd_m);
  if (!(apart.position < config.gate)) return kNever;
  const double alike = config.size_weight * std::min(apart.size, kMaxTerm) +
                       config.heading_weight * std::min(apart.heading, kMaxTerm);
  return apart.position + apart.spread + alike;
}

}  // namespace

bool same_kind(ObjectClass a, ObjectClass b) {
  const auto is_vehicle = [](ObjectClass c) {
    return c == ObjectClass::car || c == ObjectClass::van || c == ObjectClass::truck;
  };
  return a == b || (is_vehicle(a) && is_vehicle(b));
}

std::vector<Assignment> associate(std::span<const AssociationTrack> tracks,
                                  std::span<const AssociationDetection> detections,
                                  const AssociationConfig& config) {
  Eigen::MatrixXd cost(static_cast<Eigen::Index>(tracks.size()),
                       static_cast<Eigen::Index>(detections.size()));
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      cost(i, j) =
          pair_cost(tracks[static_cast<std::size_t>(i)], detections[static_cast<std::size_t>(j)], config);
    }
  }
  std::vector<Assignment> pairs = optimal_assignment(cost);
  std::erase_if(pairs, [&](const Assignment& pair) { return cost(pair.row, pair.col) >= kNever; });
  return pairs;
}

}  // namespace mlo
