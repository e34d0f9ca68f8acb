#include "mlo/detection/detect.hpp"

#include <algorithm>
#include <cassert>
#include <functional>

#include "mlo/core/log_odds.hpp"
#include "mlo/detection/cluster_detector.hpp"
#include "mlo/detection/consistency.hpp"
#include "mlo/detection/network_detector.hpp"

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

/// What is told by one scan, in view of the scan before.
FoundObjects judge(std::vector<Detection> likely, const std::optional<FoundBefore>& before,
                   const RecurrenceConfig& recurrence, double min_probability) {
  FoundObjects found;
  found.likely = std::move(likely);
  if (before) {
    found.likely =
        weigh_by_previous(std::move(found.likely), before->likely, before->T_now_before, recurrence);
  }
  for (Detection object : found.likely) {
    if (object.confidence < min_probability) continue;
    object.confidence = confidence_of(object.confidence);
    found.objects.push_back(object);
  }
  std::ranges::stable_sort(found.objects, std::greater(), &Detection::confidence);
  return found;
}

}  // namespace

FoundObjects detect(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                    const std::optional<FoundBefore>& before, const DetectionConfig& config,
                    const Network* network) {
  const ClusterConfig& cluster = config.cluster;
  switch (config.detector) {
    case Detector::cluster:
      return judge(detect_clusters(points, is_ground, cluster), before, cluster.recurrence,
                   cluster.min_probability);
    case Detector::network:
      assert(network != nullptr);
      return judge(detect_with_network(points, is_ground, *network, config.network), before,
                   config.network.recurrence, config.network.min_confidence);
    case Detector::none:
      break;
  }
  return {};
}

}  // namespace mlo
