#pragma once

// Only for the files that are compiled with LibTorch: each of them takes half a minute.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <torch/types.h>

#include "mlo/learning/batch.hpp"
#include "mlo/network/architecture.hpp"
#include "mlo/network/parameters.hpp"

namespace mlo {

/// What the network answers for a batch: rows of all examples, one after the other.
struct TorchOutput {
  std::vector<PointRows> origins;     ///< of each example: the points that its candidates began as
  std::vector<PointRows> candidates;  ///< the same, shifted; no gradient goes through them
  torch::Tensor shifts;               ///< before they are limited
  torch::Tensor class_logits;
  torch::Tensor box_codes;
};

/// 3DSSD as a function of tensors, with gradients.
class TorchNetwork {
 public:
  TorchNetwork(const NetworkArchitecture& architecture, std::uint64_t seed);

  /// @param training  normalise by the batch, and take it into the running statistics
  TorchOutput operator()(std::span<const BatchExample> batch, bool training);

  const NetworkArchitecture& architecture() const { return architecture_; }
  std::map<std::string, torch::Tensor>& parameters() { return parameters_; }
  /// Running mean and variance of each normalisation.
  std::map<std::string, torch::Tensor>& buffers() { return buffers_; }

 private:
  /// The points of a batch at one layer.
  struct Cloud {
    std::vector<PointRows> points;  ///< of each example
    torch::Tensor features;         ///< of all
  };
  void add_sequence(const SequenceSpec& spec, class Random& random);
  torch::Tensor normalise(const torch::Tensor& rows, const std::string& name, bool training);
  torch::Tensor apply(const SequenceSpec& spec, torch::Tensor rows, std::size_t first, bool training);
  torch::Tensor describe(const Cloud& cloud, const std::vector<PointRows>& centers,
                         const std::vector<std::vector<Groups>>& groups, const NetworkSequences::Layer& layer,
                         bool training);
  Cloud next_cloud(const Cloud& cloud, std::span<const BatchExample> batch, std::size_t layer, bool training);

  NetworkArchitecture architecture_;
  NetworkSequences sequences_;
  std::map<std::string, torch::Tensor> parameters_;
  std::map<std::string, torch::Tensor> buffers_;
};

}  // namespace mlo
