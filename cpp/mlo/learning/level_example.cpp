#include "mlo/learning/level_example.hpp"

#include <algorithm>

#include "mlo/perception/ground.hpp"

namespace mlo {

std::optional<TrainingExample> level(TrainingExample example, const NetworkInputSpec& spec) {
  const GroundSegmentation ground = segment_ground(example.points, {});
  const NetworkFrame frame(example.points, ground.is_ground, spec);
  if (frame.empty()) return std::nullopt;
  example.points = network_points(example.points, ground.is_ground, frame, spec);
  if (example.points.empty()) return std::nullopt;
  for (TrainingBox& box : example.boxes) {
    Eigen::Vector3d& center = box.box.center_lidar_m;
    center.z() += frame.shift_at(center.x(), center.y());
  }
  return example;
}

std::vector<TargetBox> target_boxes(const TrainingExample& example, const NetworkArchitecture& architecture) {
  std::vector<TargetBox> targets;
  for (const TrainingBox& box : example.boxes) {
    const auto known = std::ranges::find(architecture.classes, box.object_class);
    const bool counts = box.demanded && known != architecture.classes.end();
    targets.push_back(
        {box.box, counts ? static_cast<int>(known - architecture.classes.begin()) : TargetBox::kIgnored});
  }
  return targets;
}

}  // namespace mlo
