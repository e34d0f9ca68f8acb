#pragma once

#include <cmath>
#include <random>
#include <string>

#include "mlo/network/network.hpp"
#include "mlo/network/parameters.hpp"

namespace mlo::test {

/// Two layers, with fusion sampling, two scales, a shell, and both kinds of output.
inline NetworkArchitecture tiny_architecture() {
  using enum SamplingSpec::Method;
  NetworkArchitecture tiny;
  tiny.classes = {ObjectClass::car, ObjectClass::pedestrian};
  tiny.mean_sizes_lwh_m = {{4.2, 1.75, 1.5}, {0.7, 0.6, 1.7}};
  tiny.input.max_points = 512;
  tiny.layers = {{.samples = {{.method = distance, .count = 96}},
                  .scales = {{.radius_m = 1.0, .neighbours = 8, .channels = {8, 12}},
                             {.inner_radius_m = 0.5, .radius_m = 2.0, .neighbours = 12, .channels = {8}}}},
                 {.samples = {{.method = feature, .count = 32, .from = 0, .to = 64},
                              {.method = distance, .count = 16, .from = 64, .to = -1}},
                  .scales = {{.radius_m = 3.0, .neighbours = 12, .channels = {16, 16}}},
                  .aggregate = 24}};
  tiny.vote = {.candidates = 32, .channels = {16}, .max_shift_m = {3.0, 3.0, 2.0}};
  tiny.candidate_layer = {.scales = {{.radius_m = 4.0, .neighbours = 16, .channels = {32, 32}}}};
  tiny.head = {.shared = {32}, .classes = {16}, .boxes = {}};
  return tiny;
}

class WeightMaker {
 public:
  explicit WeightMaker(unsigned seed) : random_(seed) {}

  TensorFile operator()(const NetworkArchitecture& architecture) {
    file_.metadata = {{kFormatKey, kFormat}, {kArchitectureKey, to_json(architecture)}};
    const NetworkSequences all = sequences_of(architecture);
    for (const NetworkSequences::Layer& layer : all.layers) add(layer);
    add(all.candidates);
    for (const SequenceSpec* spec : {&all.vote, &all.shared, &all.classes, &all.boxes}) add(*spec);
    return file_;
  }

 private:
  void add(const NetworkSequences::Layer& layer) {
    for (const SequenceSpec& scale : layer.scales) add(scale);
    add(layer.aggregate);
  }
  void add(const SequenceSpec& spec) {
    for (std::size_t k = 0; k + 1 < spec.channels.size(); ++k) {
      const std::string name = weight_name(spec, k);
      put(name + ".weight", {spec.channels[k + 1], spec.channels[k]}, 0.0F,
          1.0F / std::sqrt(static_cast<float>(spec.channels[k])));
      if (spec.plain_end && k + 2 == spec.channels.size()) {
        put(name + ".bias", {spec.channels[k + 1]}, 0.0F, 0.1F);
        continue;
      }
      const std::string norm = norm_name(spec, k);
      put(norm + ".weight", {spec.channels[k + 1]}, 1.0F, 0.1F);
      put(norm + ".bias", {spec.channels[k + 1]}, 0.1F, 0.1F);
      put(norm + ".running_mean", {spec.channels[k + 1]}, 0.0F, 0.1F);
      put(norm + ".running_var", {spec.channels[k + 1]}, 1.0F, 0.05F);
    }
  }
  void put(const std::string& name, std::vector<std::int64_t> shape, float mean, float deviation) {
    std::normal_distribution<float> normal(mean, deviation);
    std::int64_t size = 1;
    for (const std::int64_t length : shape) size *= length;
    Tensor tensor{std::move(shape), {}};
    for (std::int64_t i = 0; i < size; ++i) tensor.values.push_back(normal(random_));
    file_.tensors[name] = tensor;
  }

  std::mt19937 random_;
  TensorFile file_;
};

inline TensorFile random_weights(const NetworkArchitecture& architecture, unsigned seed = 5) {
  return WeightMaker(seed)(architecture);
}

/// Points strewn over a square of 20 m.
inline NetworkInput random_input(Eigen::Index count, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-10.0F, 10.0F);
  NetworkInput input{PointRows(count, 3), RowMatrix(count, 1)};
  for (Eigen::Index i = 0; i < count; ++i) {
    input.points.row(i) << place(random), place(random), 0.1F * place(random) + 1.0F;
    input.features(i, 0) = input.points(i, 2);
  }
  return input;
}

}  // namespace mlo::test
