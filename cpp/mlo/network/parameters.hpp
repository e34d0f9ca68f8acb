#pragma once

#include <string>
#include <vector>

#include "mlo/core/tensor_file.hpp"
#include "mlo/network/architecture.hpp"

namespace mlo {

/// A sequence of fully connected layers, each but perhaps the last with batch normalisation and ReLU.
struct SequenceSpec {
  std::string name;           ///< that its tensors' names begin with
  std::vector<int> channels;  ///< inputs of the first layer, then outputs of each
  bool plain_end = false;     ///< the last layer has a bias, and neither normalisation nor ReLU
};

/// All sequences of a network, by what they are for. Names follow the published 3DSSD of OpenPCDet.
struct NetworkSequences {
  struct Layer {
    std::vector<SequenceSpec> scales;
    SequenceSpec aggregate;  ///< without channels: none
  };
  std::vector<Layer> layers;
  Layer candidates;
  SequenceSpec vote, shared, classes, boxes;
};

NetworkSequences sequences_of(const NetworkArchitecture& architecture);

/// Names of a layer's tensors: those of its weights and of its normalisation.
std::string weight_name(const SequenceSpec& sequence, std::size_t layer);
std::string norm_name(const SequenceSpec& sequence, std::size_t layer);

/// Metadata of a weights file.
inline constexpr const char* kFormatKey = "format";
inline constexpr const char* kFormat = "mlo 3dssd 1";
inline constexpr const char* kArchitectureKey = "architecture";

/// @throws InputError if the file is not one of 3DSSD weights
NetworkArchitecture architecture_of(const TensorFile& file);

}  // namespace mlo
