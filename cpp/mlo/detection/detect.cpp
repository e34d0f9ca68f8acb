#include "mlo/detection/detect.hpp"

#include <algorithm>
#include <functional>

#include "mlo/core/log_odds.hpp"
#include "mlo/detection/cluster_detector.hpp"
#include "mlo/detection/consistency.hpp"

namespace mlo {
namespace {

// Confidences are read on the scale of the published detectors that tracking was measured with: a box is as
// likely right as wrong at a logit of about 2, and its log-odds grow by a third of the logit
// (LifecycleConfig).
constexpr double kEvenLogit = 2.0;
constexpr double kLogitPerLogOdds = 3.0;

double confidence_of(double object_probability) {
  return probability(kEvenLogit + kLogitPerLogOdds * log_odds(object_probability));
}

FoundObjects detect_by_clusters(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                                const std::optional<FoundBefore>& before, const ClusterConfig& config) {
  FoundObjects found;
  found.likely = detect_clusters(points, is_ground, config);
  if (before) {
    found.likely =
        weigh_by_previous(std::move(found.likely), before->likely, before->T_now_before, config.recurrence);
  }
  for (Detection object : found.likely) {
    if (object.confidence < config.min_probability) continue;
    object.confidence = confidence_of(object.confidence);
    found.objects.push_back(object);
  }
  std::ranges::stable_sort(found.objects, std::greater(), &Detection::confidence);
  return found;
}

}  // namespace

FoundObjects detect(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                    const std::optional<FoundBefore>& before, const DetectionConfig& config) {
  switch (config.detector) {
    case Detector::cluster:
      return detect_by_clusters(points, is_ground, before, config.cluster);
    case Detector::none:
      break;
  }
  return {};
}

}  // namespace mlo
