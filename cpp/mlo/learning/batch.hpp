#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mlo/core/types.hpp"
#include "mlo/learning/targets.hpp"
#include "mlo/network/architecture.hpp"
#include "mlo/network/network.hpp"

namespace mlo {

/// Centres and neighbours of one layer.
struct LayerGroups {
  std::vector<std::uint32_t> centers;  ///< of the layer's input points
  std::vector<Groups> scales;
};

/// What one scan gives to a training step.
struct BatchExample {
  NetworkInput input;
  std::vector<TargetBox> boxes;
  /// Of the first layer, where it needs no features, so that it can be prepared while the step before is
  /// computed.
  LayerGroups first_layer;
};

/// @param points  in the frame of the network; at least one
BatchExample make_batch_example(std::span<const Point> points, std::vector<TargetBox> boxes,
                                const NetworkArchitecture& architecture);

/// Neighbours at all scales of a layer.
std::vector<Groups> group(const PointRows& points, const PointRows& centers, const SetAbstractionSpec& layer);

}  // namespace mlo
