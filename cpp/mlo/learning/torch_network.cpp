#include "mlo/learning/torch_network.hpp"

#include <algorithm>
#include <cmath>

#include <torch/csrc/autograd/custom_function.h>

#include "mlo/core/parallel.hpp"
#include "mlo/core/random.hpp"

namespace mlo {
namespace {

using TorchTensor = torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

// Of running statistics: batches are small, and a street has other statistics than a car park.
constexpr double kMomentum = 0.01;
constexpr double kFirstConfidence =
    0.05;  // of an untrained network, so that its many false answers cost little

// Rows of a batch's groups, with the indices of all examples in one.
struct BatchGroups {
  TorchTensor begins;   // groups + 1
  TorchTensor members;  // rows
};

// points[member] - centers[group] for each member of each group.
struct RelativeRows : torch::autograd::Function<RelativeRows> {
  static TorchTensor forward(AutogradContext* context, const TorchTensor& points, const TorchTensor& centers,
                             const TorchTensor& begins, const TorchTensor& members) {
    context->save_for_backward({begins, members});
    context->saved_data["points"] = points.size(0);
    const std::int64_t channels = points.size(1);
    TorchTensor rows = torch::empty({members.size(0), channels});
    const float* point = points.data_ptr<float>();
    const float* center = centers.data_ptr<float>();
    const std::int32_t* begin = begins.data_ptr<std::int32_t>();
    const std::int32_t* member = members.data_ptr<std::int32_t>();
    float* row = rows.data_ptr<float>();
    for (std::int64_t i = 0; i + 1 < begins.size(0); ++i, center += channels) {
      for (std::int32_t m = begin[i]; m < begin[i + 1]; ++m, row += channels) {
        const float* from = point + member[m] * channels;
        for (std::int64_t c = 0; c < channels; ++c) row[c] = from[c] - center[c];
      }
    }
    return rows;
  }

  static variable_list backward(AutogradContext* context, variable_list gradients) {
    const variable_list saved = context->get_saved_variables();
    const TorchTensor gradient = gradients[0].contiguous();
    const std::int64_t channels = gradient.size(1);
    const std::int64_t groups = saved[0].size(0) - 1;
    TorchTensor of_points = torch::zeros({context->saved_data["points"].toInt(), channels});
    TorchTensor of_centers = torch::zeros({groups, channels});
    const std::int32_t* begin = saved[0].data_ptr<std::int32_t>();
    const std::int32_t* member = saved[1].data_ptr<std::int32_t>();
    const float* row = gradient.data_ptr<float>();
    float* point = of_points.data_ptr<float>();
    float* center = of_centers.data_ptr<float>();
    for (std::int64_t i = 0; i < groups; ++i, center += channels) {
      for (std::int32_t m = begin[i]; m < begin[i + 1]; ++m, row += channels) {
        float* to = point + member[m] * channels;
        for (std::int64_t c = 0; c < channels; ++c) {
          to[c] += row[c];
          center[c] -= row[c];
        }
      }
    }
    return {of_points, of_centers, TorchTensor(), TorchTensor()};
  }
};

// Largest value of each channel over each group of rows; 0 for empty groups.
struct GroupMaximum : torch::autograd::Function<GroupMaximum> {
  static TorchTensor forward(AutogradContext* context, const TorchTensor& rows, const TorchTensor& begins) {
    const std::int64_t channels = rows.size(1);
    const std::int64_t groups = begins.size(0) - 1;
    TorchTensor largest = torch::zeros({groups, channels});
    TorchTensor from = torch::full({groups, channels}, -1, torch::kInt32);
    const std::int32_t* begin = begins.data_ptr<std::int32_t>();
    const float* row = rows.data_ptr<float>();
    float* best = largest.data_ptr<float>();
    std::int32_t* which = from.data_ptr<std::int32_t>();
    for (std::int64_t i = 0; i < groups; ++i, best += channels, which += channels) {
      for (std::int32_t m = begin[i]; m < begin[i + 1]; ++m, row += channels) {
        for (std::int64_t c = 0; c < channels; ++c) {
          const bool is_better = row[c] > best[c];
          best[c] = is_better ? row[c] : best[c];
          which[c] = is_better ? m : which[c];
        }
      }
    }
    context->save_for_backward({from});
    context->saved_data["rows"] = rows.size(0);
    return largest;
  }

  static variable_list backward(AutogradContext* context, variable_list gradients) {
    const TorchTensor from = context->get_saved_variables()[0];
    const TorchTensor gradient = gradients[0].contiguous();
    const std::int64_t channels = gradient.size(1);
    TorchTensor of_rows = torch::zeros({context->saved_data["rows"].toInt(), channels});
    const std::int32_t* which = from.data_ptr<std::int32_t>();
    const float* value = gradient.data_ptr<float>();
    float* row = of_rows.data_ptr<float>();
    for (std::int64_t i = 0; i < gradient.size(0); ++i) {
      for (std::int64_t c = 0; c < channels; ++c, ++which, ++value) {
        if (*which >= 0)
          row[*which * channels + c] = *value;  // after ReLU, what is not above 0 has no gradient
      }
    }
    return {of_rows, TorchTensor()};
  }
};

template <class Rows>
TorchTensor to_tensor(const Rows& rows) {
  TorchTensor tensor = torch::empty({rows.rows(), rows.cols()});
  std::copy_n(rows.data(), rows.size(), tensor.template data_ptr<float>());
  return tensor;
}

TorchTensor joined(const std::vector<PointRows>& parts) {
  std::vector<TorchTensor> tensors;
  for (const PointRows& part : parts) tensors.push_back(to_tensor(part));
  return torch::cat(tensors);
}

// Rows [begin, begin + count) of a tensor as a matrix of our own.
RowMatrix rows_of(const TorchTensor& tensor, Eigen::Index begin, Eigen::Index count) {
  const TorchTensor contiguous = tensor.detach().contiguous();
  return Eigen::Map<const RowMatrix>(contiguous.data_ptr<float>(), contiguous.size(0), contiguous.size(1))
      .middleRows(begin, count);
}

BatchGroups join_groups(const std::vector<std::vector<Groups>>& by_example, std::size_t scale,
                        const std::vector<PointRows>& points) {
  std::vector<std::int32_t> begins{0};
  std::vector<std::int32_t> members;
  std::int32_t offset = 0;
  for (std::size_t e = 0; e < by_example.size(); ++e) {
    const Groups& groups = by_example[e][scale];
    const auto before = static_cast<std::int32_t>(members.size());
    for (std::size_t i = 1; i < groups.begins.size(); ++i) {
      begins.push_back(before + static_cast<std::int32_t>(groups.begins[i]));
    }
    for (const std::uint32_t member : groups.members)
      members.push_back(offset + static_cast<std::int32_t>(member));
    offset += static_cast<std::int32_t>(points[e].rows());
  }
  return {torch::tensor(begins, torch::kInt32), torch::tensor(members, torch::kInt32)};
}

PointRows selected(const PointRows& points, const std::vector<std::uint32_t>& indices) {
  PointRows result(static_cast<Eigen::Index>(indices.size()), 3);
  for (std::size_t i = 0; i < indices.size(); ++i)
    result.row(static_cast<Eigen::Index>(i)) = points.row(indices[i]);
  return result;
}

TorchTensor random_normal(std::int64_t rows, std::int64_t columns, double deviation, Random& random) {
  TorchTensor tensor = torch::empty({rows, columns});
  float* value = tensor.data_ptr<float>();
  for (std::int64_t i = 0; i < rows * columns; ++i)
    value[i] = static_cast<float>(deviation * random.normal());
  return tensor;
}

}  // namespace

TorchNetwork::TorchNetwork(const NetworkArchitecture& architecture, std::uint64_t seed)
    : architecture_(architecture), sequences_(sequences_of(architecture)) {
  Random random(seed);
  std::vector<NetworkSequences::Layer> layers = sequences_.layers;
  layers.push_back(sequences_.candidates);
  for (const NetworkSequences::Layer& layer : layers) {
    for (const SequenceSpec& scale : layer.scales) add_sequence(scale, random);
    add_sequence(layer.aggregate, random);
  }
  for (const SequenceSpec* spec :
       {&sequences_.vote, &sequences_.shared, &sequences_.classes, &sequences_.boxes}) {
    add_sequence(*spec, random);
  }
  const std::string last = weight_name(sequences_.classes, sequences_.classes.channels.size() - 2);
  parameters_.at(last + ".bias").fill_(std::log(kFirstConfidence / (1.0 - kFirstConfidence)));
  for (auto& [name, parameter] : parameters_) parameter.set_requires_grad(true);
}

void TorchNetwork::add_sequence(const SequenceSpec& spec, Random& random) {
  for (std::size_t k = 0; k + 1 < spec.channels.size(); ++k) {
    const std::int64_t inputs = spec.channels[k];
    const std::int64_t outputs = spec.channels[k + 1];
    const bool is_plain = spec.plain_end && k + 2 == spec.channels.size();
    const std::string weight = weight_name(spec, k);
    const double deviation = is_plain ? 0.01 : std::sqrt(2.0 / static_cast<double>(inputs));
    parameters_[weight + ".weight"] = random_normal(outputs, inputs, deviation, random);
    if (is_plain) {
      parameters_[weight + ".bias"] = torch::zeros({outputs});
      continue;
    }
    const std::string norm = norm_name(spec, k);
    parameters_[norm + ".weight"] = torch::ones({outputs});
    parameters_[norm + ".bias"] = torch::zeros({outputs});
    buffers_[norm + ".running_mean"] = torch::zeros({outputs});
    buffers_[norm + ".running_var"] = torch::ones({outputs});
  }
}

TorchTensor TorchNetwork::normalise(const TorchTensor& rows, const std::string& name, bool training) {
  // One row alone has no variance.
  const bool by_batch = training && rows.size(0) > 1;
  return torch::batch_norm(rows, parameters_.at(name + ".weight"), parameters_.at(name + ".bias"),
                           buffers_.at(name + ".running_mean"), buffers_.at(name + ".running_var"), by_batch,
                           kMomentum, architecture_.batch_norm_eps, false);
}

TorchTensor TorchNetwork::apply(const SequenceSpec& spec, TorchTensor rows, std::size_t first,
                                bool training) {
  for (std::size_t k = first; k + 1 < spec.channels.size(); ++k) {
    const std::string weight = weight_name(spec, k);
    rows = torch::matmul(rows, parameters_.at(weight + ".weight").t());
    if (const auto bias = parameters_.find(weight + ".bias"); bias != parameters_.end())
      rows = rows + bias->second;
    if (spec.plain_end && k + 2 == spec.channels.size()) return rows;
    rows = normalise(rows, norm_name(spec, k), training);
    torch::relu_(rows);
  }
  return rows;
}

// The first layer of a group is computed once per point and once per centre, as in Network.
TorchTensor TorchNetwork::describe(const Cloud& cloud, const std::vector<PointRows>& centers,
                                   const std::vector<std::vector<Groups>>& groups,
                                   const NetworkSequences::Layer& layer, bool training) {
  const TorchTensor rows = torch::cat({joined(cloud.points), cloud.features}, 1);
  const TorchTensor center_rows = joined(centers);
  std::vector<TorchTensor> scales;
  for (std::size_t s = 0; s < layer.scales.size(); ++s) {
    const SequenceSpec& spec = layer.scales[s];
    const TorchTensor weight = parameters_.at(weight_name(spec, 0) + ".weight");
    const BatchGroups joined_groups = join_groups(groups, s, cloud.points);
    TorchTensor hidden = RelativeRows::apply(torch::matmul(rows, weight.t()),
                                             torch::matmul(center_rows, weight.slice(1, 0, 3).t()),
                                             joined_groups.begins, joined_groups.members);
    hidden = normalise(hidden, norm_name(spec, 0), training);
    torch::relu_(hidden);
    scales.push_back(GroupMaximum::apply(apply(spec, hidden, 1, training), joined_groups.begins));
  }
  const TorchTensor all = torch::cat(scales, 1);
  return layer.aggregate.channels.empty() ? all : apply(layer.aggregate, all, 0, training);
}

TorchNetwork::Cloud TorchNetwork::next_cloud(const Cloud& cloud, std::span<const BatchExample> batch,
                                             std::size_t layer, bool training) {
  const SetAbstractionSpec& spec = architecture_.layers[layer];
  std::vector<Eigen::Index> begins{0};
  for (const PointRows& points : cloud.points) begins.push_back(begins.back() + points.rows());
  Cloud next;
  next.points.resize(batch.size());
  std::vector<std::vector<Groups>> groups(batch.size());
  const TorchTensor features = cloud.features.detach().contiguous();
  parallel_for_each_index(batch.size(), [&](std::size_t e) {
    const LayerGroups& prepared = batch[e].first_layer;
    const bool is_prepared = layer == 0 && !prepared.scales.empty();
    const PointRows& points = cloud.points[e];
    next.points[e] = selected(
        points, is_prepared ? prepared.centers
                            : sample(points, rows_of(features, begins[e], points.rows()), spec.samples));
    groups[e] = is_prepared ? prepared.scales : group(points, next.points[e], spec);
  });
  next.features = describe(cloud, next.points, groups, sequences_.layers[layer], training);
  return next;
}

TorchOutput TorchNetwork::operator()(std::span<const BatchExample> batch, bool training) {
  Cloud cloud;
  std::vector<TorchTensor> features;
  for (const BatchExample& example : batch) {
    cloud.points.push_back(example.input.points);
    features.push_back(to_tensor(example.input.features));
  }
  cloud.features = torch::cat(features);
  for (std::size_t layer = 0; layer < architecture_.layers.size(); ++layer) {
    cloud = next_cloud(cloud, batch, layer, training);
  }
  TorchOutput output;
  std::vector<TorchTensor> seeds;
  std::int64_t begin = 0;
  for (const PointRows& points : cloud.points) {
    const auto count = std::min<Eigen::Index>(architecture_.vote.candidates, points.rows());
    output.origins.emplace_back(points.topRows(count));
    seeds.push_back(cloud.features.slice(0, begin, begin + count));
    begin += points.rows();
  }
  output.shifts = apply(sequences_.vote, torch::cat(seeds), 0, training);
  std::vector<std::vector<Groups>> groups;
  Eigen::Index row = 0;
  for (std::size_t e = 0; e < batch.size(); ++e) {
    const PointRows& origins = output.origins[e];
    output.candidates.emplace_back(origins + limited_shifts(rows_of(output.shifts, row, origins.rows()),
                                                            architecture_.vote.max_shift_m));
    groups.push_back(group(cloud.points[e], output.candidates.back(), architecture_.candidate_layer));
    row += origins.rows();
  }
  const TorchTensor described =
      apply(sequences_.shared, describe(cloud, output.candidates, groups, sequences_.candidates, training), 0,
            training);
  output.class_logits = apply(sequences_.classes, described, 0, training);
  output.box_codes = apply(sequences_.boxes, described, 0, training);
  return output;
}

}  // namespace mlo
