#pragma once

#include <optional>
#include <vector>

#include "mlo/detection/network_input.hpp"
#include "mlo/learning/targets.hpp"
#include "mlo/network/architecture.hpp"
#include "mlo/training/example.hpp"

namespace mlo {

/// An example as a network sees it: ground found, points thinned, points and boxes in the network's frame.
/// Nothing if no ground was found, or nothing is left.
std::optional<TrainingExample> level(TrainingExample example, const NetworkInputSpec& spec);

/// What the network should find in an example.
std::vector<TargetBox> target_boxes(const TrainingExample& example, const NetworkArchitecture& architecture);

}  // namespace mlo
