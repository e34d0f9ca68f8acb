#include "mlo/detection/suppression.hpp"

#include <algorithm>
#include <functional>

#include "mlo/core/box_overlap.hpp"

namespace mlo {
std::vector<Detection> suppress_overlapping(std::vector<Detection> detections, double max_shared) {
  std::ranges::stable_sort(detections, std::greater(), &Detection::confidence);
  std::vector<Detection> kept;
  for (const Detection& detection : detections) {
    const bool is_taken = std::ranges::any_of(
        kept, [&](const Detection& better) { return footprint_iou(better.box, detection.box) > max_shared; });
    if (!is_taken) kept.push_back(detection);
  }
  return kept;
}

}  // namespace mlo
