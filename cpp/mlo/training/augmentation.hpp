#pragma once

#include <cstdint>

#include "mlo/core/random.hpp"
#include "mlo/training/config.hpp"
#include "mlo/training/example.hpp"
#include "mlo/training/object_bank.hpp"

namespace mlo {

// Each step takes an example and gives it back changed; points stay in their boxes, in their order.

/// Left and right exchanged: y becomes -y.
TrainingExample flipped(TrainingExample example);
/// Turned about the lidar's z axis.
TrainingExample rotated(TrainingExample example, double angle_rad);
/// All lengths multiplied by a factor > 0, about the lidar.
TrainingExample scaled(TrainingExample example, double factor);
/// Objects shifted over the ground and turned, each by itself with its points, where they collide with
/// nothing; what lay at the new place is removed. Boxes that share ground with others stay as they are.
TrainingExample with_object_noise(TrainingExample example, const ObjectNoiseConfig& config, Random& random);

/// Objects of the bank, noise of each object, flip, rotation, scaling, as the configuration says. The same
/// seed gives the same example. Its view is that of all its points (nothing), as directions have changed.
TrainingExample augment(TrainingExample example, const ObjectBank& bank, const AugmentationConfig& config,
                        std::uint64_t seed);

}  // namespace mlo
