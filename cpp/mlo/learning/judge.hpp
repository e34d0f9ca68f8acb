#pragma once

#include <span>
#include <vector>

#include "mlo/network/network.hpp"
#include "mlo/training/example.hpp"

namespace mlo {

/// Average precision (3D, moderate) of each class of a network on levelled examples, as `mlo eval detection`
/// counts it: IoU 0.7 for vehicles, 0.5 for people.
std::vector<double> judge(const Network& network, std::span<const TrainingExample> examples);

}  // namespace mlo
