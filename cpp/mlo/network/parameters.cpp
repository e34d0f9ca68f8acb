#include "mlo/network/parameters.hpp"

#include <fmt/format.h>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

std::vector<int> joined(int inputs, const std::vector<int>& channels) {
  std::vector<int> all{inputs};
  all.insert(all.end(), channels.begin(), channels.end());
  return all;
}

// A group is told by relative positions and features.
NetworkSequences::Layer layer_sequences(const std::string& name, int features,
                                        const SetAbstractionSpec& spec) {
  NetworkSequences::Layer layer;
  int sum = 0;
  for (std::size_t s = 0; s < spec.scales.size(); ++s) {
    layer.scales.push_back(
        {fmt::format("{}.mlps.{}", name, s), joined(3 + features, spec.scales[s].channels)});
    sum += spec.scales[s].channels.back();
  }
  layer.aggregate.name = name + ".out_aggregation";
  if (spec.aggregate > 0) layer.aggregate.channels = {sum, spec.aggregate};
  return layer;
}

SequenceSpec ending_in(std::string name, int inputs, const std::vector<int>& channels, int outputs) {
  SequenceSpec sequence{std::move(name), joined(inputs, channels), true};
  sequence.channels.push_back(outputs);
  return sequence;
}

}  // namespace

NetworkSequences sequences_of(const NetworkArchitecture& architecture) {
  NetworkSequences all;
  int features = architecture.channels_in();
  for (std::size_t i = 0; i < architecture.layers.size(); ++i) {
    all.layers.push_back(
        layer_sequences(fmt::format("backbone_3d.SA_modules.{}", i), features, architecture.layers[i]));
    features = channels_out(architecture.layers[i]);
  }
  all.candidates = layer_sequences("point_head.SA_module", features, architecture.candidate_layer);
  all.vote = ending_in("point_head.vote_layers", features, architecture.vote.channels, 3);
  const HeadSpec& head = architecture.head;
  all.shared = {"point_head.shared_fc_layer",
                joined(channels_out(architecture.candidate_layer), head.shared)};
  const int shared = all.shared.channels.back();
  all.classes =
      ending_in("point_head.cls_layers", shared, head.classes, static_cast<int>(architecture.classes.size()));
  all.boxes = ending_in("point_head.reg_layers", shared, head.boxes, architecture.box_code.size());
  return all;
}

std::string weight_name(const SequenceSpec& sequence, std::size_t layer) {
  return fmt::format("{}.{}", sequence.name, 3 * layer);
}

std::string norm_name(const SequenceSpec& sequence, std::size_t layer) {
  return fmt::format("{}.{}", sequence.name, 3 * layer + 1);
}

NetworkArchitecture architecture_of(const TensorFile& file) {
  const auto format = file.metadata.find(kFormatKey);
  const auto architecture = file.metadata.find(kArchitectureKey);
  if (format == file.metadata.end() || format->second != kFormat || architecture == file.metadata.end()) {
    throw InputError(
        fmt::format("the weights are not of '{}': take a file that 'mlo train' wrote, or convert a published "
                    "checkpoint with scripts/convert_3dssd_checkpoint.py",
                    kFormat));
  }
  return parse_architecture(architecture->second);
}

}  // namespace mlo
