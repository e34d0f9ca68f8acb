#include "mlo/learning/judge.hpp"

#include <algorithm>
#include <string>

#include "mlo/core/parallel.hpp"
#include "mlo/detection/network_detector.hpp"
#include "mlo/evaluation/detection_ap.hpp"

namespace mlo {
namespace {

constexpr double kVehicleOverlap = 0.7;
constexpr double kPersonOverlap = 0.5;
constexpr double kMinConfidence = 0.05;

}  // namespace

std::vector<double> judge(const Network& network, std::span<const TrainingExample> examples) {
  std::vector<DetectionFrame> frames(examples.size());
  parallel_for_each_index(examples.size(), [&](std::size_t i) {
    const TrainingExample& example = examples[i];
    for (const TrainingBox& box : example.boxes) frames[i].truth.push_back(box);
    NetworkConfig config;
    config.min_candidate = kMinConfidence;
    for (const Detection& found : detect_in_network_frame(example.points, network, config)) {
      frames[i].detections.push_back({std::string(to_string(found.object_class)), found.box, found.confidence,
                                      height_all_round_px(found.box)});
    }
  });
  std::vector<double> precisions;
  for (const ObjectClass object_class : network.architecture().classes) {
    const bool is_person = object_class == ObjectClass::pedestrian || object_class == ObjectClass::cyclist;
    const DetectionProtocol protocol{.object_class = std::string(to_string(object_class)),
                                     .min_overlap = is_person ? kPersonOverlap : kVehicleOverlap};
    precisions.push_back(average_precision(frames, protocol, Difficulty::moderate).ap);
  }
  return precisions;
}

}  // namespace mlo
