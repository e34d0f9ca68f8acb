#include "mlo/network/network.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/core/parallel.hpp"
#include "mlo/network/parameters.hpp"

namespace mlo {
namespace {

// Centres, or rows, that one task takes: their groups' hidden layers stay in the cache.
constexpr std::size_t kCentersPerTask = 16;
constexpr std::size_t kRowsPerTask = 128;

const std::vector<float>& values_of(const TensorFile& file, const std::string& name,
                                    const std::vector<std::int64_t>& shape) {
  const auto tensor = file.tensors.find(name);
  if (tensor == file.tensors.end()) {
    throw InputError(fmt::format("the weights lack the tensor '{}' that their architecture needs", name));
  }
  if (tensor->second.shape != shape) {
    throw InputError(
        fmt::format("the weights do not fit their architecture: tensor '{}' has another shape", name));
  }
  if (!std::ranges::all_of(tensor->second.values, [](float value) { return std::isfinite(value); })) {
    throw InputError(fmt::format("the weights' tensor '{}' holds values that are not finite", name));
  }
  return tensor->second.values;
}

Eigen::RowVectorXf row_of(const TensorFile& file, const std::string& name, std::int64_t size) {
  return Eigen::Map<const Eigen::RowVectorXf>(values_of(file, name, {size}).data(), size);
}

// W' = s W and b' = s (b - mean) + beta with s = gamma / sqrt(variance + eps).
void fold_norm(const TensorFile& file, const std::string& name, double eps, DenseLayer& layer) {
  const auto size = static_cast<std::int64_t>(layer.bias.size());
  const Eigen::RowVectorXf variance = row_of(file, name + ".running_var", size);
  const Eigen::RowVectorXf scale =
      row_of(file, name + ".weight", size).array() / (variance.array() + static_cast<float>(eps)).sqrt();
  layer.bias = (scale.array() * (layer.bias - row_of(file, name + ".running_mean", size)).array()).matrix() +
               row_of(file, name + ".bias", size);
  layer.weight = scale.asDiagonal() * layer.weight;
}

DenseSequence sequence_from(const TensorFile& file, const SequenceSpec& spec, double eps) {
  DenseSequence sequence;
  for (std::size_t k = 0; k + 1 < spec.channels.size(); ++k) {
    const std::int64_t inputs = spec.channels[k];
    const std::int64_t outputs = spec.channels[k + 1];
    const bool is_plain = spec.plain_end && k + 2 == spec.channels.size();
    const std::string name = weight_name(spec, k);
    DenseLayer layer;
    layer.weight = Eigen::Map<const RowMatrix>(values_of(file, name + ".weight", {outputs, inputs}).data(),
                                               outputs, inputs);
    layer.bias = Eigen::RowVectorXf::Zero(outputs);
    if (is_plain || file.tensors.contains(name + ".bias")) layer.bias = row_of(file, name + ".bias", outputs);
    if (!is_plain) fold_norm(file, norm_name(spec, k), eps, layer);
    layer.rectified = !is_plain;
    sequence.push_back(std::move(layer));
  }
  return sequence;
}

RowMatrix run_layers(const DenseSequence& sequence, const RowMatrix& rows) {
  if (sequence.empty()) return rows;
  const Eigen::Index outputs = sequence.back().weight.rows();
  RowMatrix result(rows.rows(), outputs);
  const auto num_rows = static_cast<std::size_t>(rows.rows());
  parallel_for_each_index((num_rows + kRowsPerTask - 1) / kRowsPerTask, [&](std::size_t task) {
    const auto begin = static_cast<Eigen::Index>(task * kRowsPerTask);
    const Eigen::Index count = std::min<Eigen::Index>(kRowsPerTask, rows.rows() - begin);
    RowMatrix block = rows.middleRows(begin, count);
    for (const DenseLayer& layer : sequence) block = layer(block);
    result.middleRows(begin, count) = block;
  });
  return result;
}

// The first layer of a group sees a point relative to its centre: W_x (p - c) + W_f f + b. What belongs to
// the point is the same in each group that the point is in, so that it is computed once: W_x p + W_f f + b,
// minus W_x c.
struct FirstLayer {
  RowMatrix of_points;
  RowMatrix of_centers;
};

FirstLayer first_layer(const DenseLayer& layer, const PointRows& points, const RowMatrix& features,
                       const PointRows& centers) {
  RowMatrix rows(points.rows(), 3 + features.cols());
  rows << points, features;
  const DenseLayer linear{layer.weight, layer.bias, false};
  const DenseLayer positions{layer.weight.leftCols(3), Eigen::RowVectorXf::Zero(layer.bias.size()), false};
  return {run_layers({linear}, rows), run_layers({positions}, centers)};
}

// Maximum over each group of what the layers make of its members; 0, the least there can be, for an empty
// group.
RowMatrix pool_groups(const Groups& groups, const FirstLayer& first, const DenseSequence& sequence) {
  const Eigen::Index outputs = sequence.back().weight.rows();
  RowMatrix pooled = RowMatrix::Zero(static_cast<Eigen::Index>(groups.size()), outputs);
  const std::size_t num_tasks = (groups.size() + kCentersPerTask - 1) / kCentersPerTask;
  parallel_for_each_index(num_tasks, [&](std::size_t task) {
    const std::size_t begin = task * kCentersPerTask;
    const std::size_t end = std::min(groups.size(), begin + kCentersPerTask);
    RowMatrix rows(groups.begins[end] - groups.begins[begin], first.of_points.cols());
    Eigen::Index row = 0;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::uint32_t m = groups.begins[i]; m < groups.begins[i + 1]; ++m, ++row) {
        rows.row(row) =
            (first.of_points.row(groups.members[m]) - first.of_centers.row(static_cast<Eigen::Index>(i)))
                .cwiseMax(0.0F);
      }
    }
    for (std::size_t k = 1; k < sequence.size(); ++k) rows = sequence[k](rows);
    row = 0;
    for (std::size_t i = begin; i < end; ++i) {
      auto best = pooled.row(static_cast<Eigen::Index>(i));
      for (std::uint32_t m = groups.begins[i]; m < groups.begins[i + 1]; ++m, ++row) {
        best = best.cwiseMax(rows.row(row));
      }
    }
  });
  return pooled;
}

template <class Rows>
Rows selected(const Rows& rows, const std::vector<std::uint32_t>& indices) {
  Rows result(static_cast<Eigen::Index>(indices.size()), rows.cols());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    result.row(static_cast<Eigen::Index>(i)) = rows.row(indices[i]);
  }
  return result;
}

}  // namespace

RowMatrix DenseLayer::operator()(const RowMatrix& rows) const {
  RowMatrix result(rows.rows(), weight.rows());
  result.noalias() = rows * weight.transpose();
  result.rowwise() += bias;
  if (rectified) result = result.cwiseMax(0.0F);
  return result;
}

std::vector<std::uint32_t> sample(const PointRows& points, const RowMatrix& features,
                                  const std::vector<SamplingSpec>& samples) {
  std::vector<std::uint32_t> all;
  for (const SamplingSpec& spec : samples) {
    const Eigen::Index end = spec.to < 0 ? points.rows() : std::min<Eigen::Index>(spec.to, points.rows());
    const Eigen::Index begin = std::min<Eigen::Index>(spec.from, end);
    const bool by_feature = spec.method == SamplingSpec::Method::feature;
    RowMatrix rows(end - begin, by_feature ? 3 + features.cols() : 3);
    rows.leftCols(3) = points.middleRows(begin, end - begin);
    if (by_feature) rows.rightCols(features.cols()) = features.middleRows(begin, end - begin);
    for (const std::uint32_t index : farthest_point_sampling(rows, static_cast<std::size_t>(spec.count))) {
      all.push_back(static_cast<std::uint32_t>(begin) + index);
    }
  }
  return all;
}

PointRows limited_shifts(const RowMatrix& shifts, const Eigen::Vector3d& max_shift_m) {
  PointRows limited = shifts;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto limit = static_cast<float>(max_shift_m[axis]);
    limited.col(axis) = limited.col(axis).cwiseMax(-limit).cwiseMin(limit);
  }
  return limited;
}

Network::Network(const TensorFile& file) : architecture_(architecture_of(file)) {
  const NetworkSequences all = sequences_of(architecture_);
  const double eps = architecture_.batch_norm_eps;
  const auto layer_from = [&](const NetworkSequences::Layer& spec) {
    Layer layer;
    for (const SequenceSpec& scale : spec.scales) layer.scales.push_back(sequence_from(file, scale, eps));
    layer.aggregate = sequence_from(file, spec.aggregate, eps);
    return layer;
  };
  for (const NetworkSequences::Layer& spec : all.layers) layers_.push_back(layer_from(spec));
  candidates_ = layer_from(all.candidates);
  vote_ = sequence_from(file, all.vote, eps);
  shared_ = sequence_from(file, all.shared, eps);
  classes_ = sequence_from(file, all.classes, eps);
  boxes_ = sequence_from(file, all.boxes, eps);
}

RowMatrix Network::describe(const PointRows& points, const RowMatrix& features, const PointRows& centers,
                            const SetAbstractionSpec& spec, const Layer& layer) const {
  std::vector<RowMatrix> by_scale;
  Eigen::Index channels = 0;
  for (std::size_t s = 0; s < spec.scales.size(); ++s) {
    const ScaleSpec& scale = spec.scales[s];
    const Groups groups = query_balls(points, centers,
                                      {.inner_radius_m = static_cast<float>(scale.inner_radius_m),
                                       .radius_m = static_cast<float>(scale.radius_m),
                                       .neighbours = static_cast<std::size_t>(scale.neighbours)});
    const FirstLayer first = first_layer(layer.scales[s].front(), points, features, centers);
    by_scale.push_back(pool_groups(groups, first, layer.scales[s]));
    channels += by_scale.back().cols();
  }
  RowMatrix joined(centers.rows(), channels);
  Eigen::Index column = 0;
  for (const RowMatrix& one : by_scale) {
    joined.middleCols(column, one.cols()) = one;
    column += one.cols();
  }
  return run_layers(layer.aggregate, joined);
}

NetworkOutput Network::operator()(const NetworkInput& input) const {
  PointRows points = input.points;
  RowMatrix features = input.features;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const SetAbstractionSpec& spec = architecture_.layers[i];
    const PointRows centers = selected(points, sample(points, features, spec.samples));
    features = describe(points, features, centers, spec, layers_[i]);
    points = centers;
  }
  const Eigen::Index count = std::min<Eigen::Index>(architecture_.vote.candidates, points.rows());
  const RowMatrix shifts = run_layers(vote_, features.topRows(count));
  NetworkOutput output;
  output.candidates = points.topRows(count) + limited_shifts(shifts, architecture_.vote.max_shift_m);
  const RowMatrix described = run_layers(
      shared_, describe(points, features, output.candidates, architecture_.candidate_layer, candidates_));
  output.class_logits = run_layers(classes_, described);
  output.box_codes = run_layers(boxes_, described);
  return output;
}

}  // namespace mlo
