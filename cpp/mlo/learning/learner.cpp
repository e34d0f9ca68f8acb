#include "mlo/learning/learner.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <torch/types.h>
#include <torch/utils.h>

#include "mlo/core/error.hpp"
#include "mlo/learning/torch_network.hpp"

// Of OpenBLAS, where that is what LibTorch multiplies with: it has threads of its own.
extern "C" [[gnu::weak]] void openblas_set_num_threads(int threads);

namespace mlo {
namespace {

using TorchTensor = torch::Tensor;

// Where smooth L1 turns from the square to the absolute error. Overlaps of 70 % are lost by decimetres:
// below, errors have to pull as larger ones do.
constexpr double kSmoothWithin = 0.03;  // of codes, a sixth of a metre for a car's center
constexpr double kSmoothCorner_m = 0.1;
constexpr double kCornerWeight = 2.0;
constexpr double kBeta1 = 0.9;  // of Adam
constexpr double kBeta2 = 0.99;
constexpr double kAdamEps = 1e-8;

// Names in a state.
constexpr const char* kFirstMoment = "first_moment.";
constexpr const char* kSecondMoment = "second_moment.";
constexpr const char* kStepsKey = "steps";

/// Targets of all examples of a batch, one after the other.
struct BatchTargets {
  TorchTensor class_index, centerness, codes, angle_bin, angle_residual, boxes, is_on_object, shifts;
};

template <class Value>
TorchTensor tensor_of(const std::vector<Value>& values, torch::ScalarType type) {
  TorchTensor tensor = torch::empty({static_cast<std::int64_t>(values.size())}, type);
  std::copy(values.begin(), values.end(), static_cast<Value*>(tensor.data_ptr()));
  return tensor;
}

template <class Rows>
TorchTensor tensor_of_rows(const Rows& rows) {
  TorchTensor tensor = torch::empty({rows.rows(), rows.cols()});
  std::copy_n(rows.data(), rows.size(), tensor.template data_ptr<float>());
  return tensor;
}

BatchTargets targets_of(const TorchOutput& output, std::span<const BatchExample> batch,
                        const NetworkArchitecture& architecture) {
  std::vector<TorchTensor> class_index, centerness, codes, angle_bin, angle_residual, boxes, on_object,
      shifts;
  for (std::size_t e = 0; e < batch.size(); ++e) {
    const CandidateTargets one =
        assign_targets(output.origins[e], output.candidates[e], batch[e].boxes, architecture);
    class_index.push_back(tensor_of(one.class_index, torch::kInt64));
    centerness.push_back(tensor_of(one.centerness, torch::kFloat32));
    codes.push_back(tensor_of_rows(one.codes));
    angle_bin.push_back(tensor_of(one.angle_bin, torch::kInt64));
    angle_residual.push_back(tensor_of(one.angle_residual, torch::kFloat32));
    boxes.push_back(tensor_of_rows(one.corners));
    on_object.push_back(tensor_of(one.is_on_object, torch::kUInt8));
    shifts.push_back(tensor_of_rows(one.shifts));
  }
  return {torch::cat(class_index),    torch::cat(centerness), torch::cat(codes),     torch::cat(angle_bin),
          torch::cat(angle_residual), torch::cat(boxes),      torch::cat(on_object), torch::cat(shifts)};
}

TorchTensor joined(const std::vector<PointRows>& parts) {
  std::vector<TorchTensor> tensors;
  for (const PointRows& part : parts) tensors.push_back(tensor_of_rows(part));
  return torch::cat(tensors);
}

TorchTensor class_loss(const TorchOutput& output, const BatchTargets& targets, double positives) {
  const std::int64_t classes = output.class_logits.size(1);
  const TorchTensor is_object = targets.class_index.ge(0);
  const TorchTensor one_hot = torch::one_hot(targets.class_index.clamp_min(0), classes).to(torch::kFloat32);
  const TorchTensor labels = one_hot * (targets.centerness * is_object).unsqueeze(1);
  const TorchTensor counts =
      targets.class_index.ne(CandidateTargets::kIgnored).to(torch::kFloat32).unsqueeze(1);
  const TorchTensor loss =
      torch::binary_cross_entropy_with_logits(output.class_logits, labels, {}, {}, at::Reduction::None);
  return (loss * counts).sum() / std::max(positives, 1.0);
}

// Corners of boxes (center, size, yaw) as rows of 24 numbers.
TorchTensor corners_of(const TorchTensor& boxes) {
  const TorchTensor signs = torch::tensor({{1.F, 1.F, 1.F},
                                           {1.F, -1.F, 1.F},
                                           {-1.F, -1.F, 1.F},
                                           {-1.F, 1.F, 1.F},
                                           {1.F, 1.F, -1.F},
                                           {1.F, -1.F, -1.F},
                                           {-1.F, -1.F, -1.F},
                                           {-1.F, 1.F, -1.F}});
  const TorchTensor local = 0.5 * signs.unsqueeze(0) * boxes.slice(1, 3, 6).unsqueeze(1);
  const TorchTensor yaw = boxes.slice(1, 6, 7);
  const TorchTensor c = yaw.cos();
  const TorchTensor s = yaw.sin();
  const TorchTensor x = local.select(2, 0);
  const TorchTensor y = local.select(2, 1);
  return torch::stack({c * x - s * y, s * x + c * y, local.select(2, 2)}, 2) +
         boxes.slice(1, 0, 3).unsqueeze(1);
}

/// Of the positives: what the codes say.
struct DecodedPositives {
  TorchTensor codes;     ///< the first six numbers
  TorchTensor residual;  ///< in the true bin
  TorchTensor boxes;     ///< center, size, yaw in the true bin
};

DecodedPositives decode(const TorchTensor& codes, const TorchTensor& candidates,
                        const TorchTensor& class_index, const TorchTensor& bin,
                        const NetworkArchitecture& architecture) {
  const BoxCodeSpec& spec = architecture.box_code;
  TorchTensor means = torch::empty({static_cast<std::int64_t>(architecture.mean_sizes_lwh_m.size()), 3});
  TorchTensor scales = torch::ones_like(means);
  for (std::size_t k = 0; k < architecture.mean_sizes_lwh_m.size(); ++k) {
    const Eigen::Vector3d& mean = architecture.mean_sizes_lwh_m[k];
    const Eigen::Vector3f scale =
        Eigen::Vector3d(mean.head<2>().norm(), mean.head<2>().norm(), mean.z()).cast<float>();
    for (int axis = 0; axis < 3; ++axis) {
      means[static_cast<std::int64_t>(k)][axis] = static_cast<float>(mean[axis]);
      if (spec.center_in_sizes) scales[static_cast<std::int64_t>(k)][axis] = scale[axis];
    }
  }
  DecodedPositives decoded;
  decoded.codes = codes.slice(1, 0, 6);
  const TorchTensor center = candidates + codes.slice(1, 0, 3) * scales.index_select(0, class_index);
  const TorchTensor size =
      spec.log_size ? means.index_select(0, class_index) * codes.slice(1, 3, 6).clamp(-3.0, 3.0).exp()
                    : (2.0 * codes.slice(1, 3, 6)).clamp_min(0.05);
  decoded.residual = codes.slice(1, 6 + spec.angle_bins).gather(1, bin.unsqueeze(1)).squeeze(1);
  const double bin_rad = 2.0 * M_PI / spec.angle_bins;
  const TorchTensor yaw = spec.first_angle_rad + bin_rad * (bin.to(torch::kFloat32) + 0.5 * decoded.residual);
  decoded.boxes = torch::cat({center, size, yaw.unsqueeze(1)}, 1);
  return decoded;
}

TorchTensor smooth(const TorchTensor& estimate, const TorchTensor& truth) {
  return torch::smooth_l1_loss(estimate, truth, at::Reduction::Sum, kSmoothWithin);
}

// The box may be the other way round: its corners are then those of the true box turned by half a turn.
TorchTensor corner_loss(const TorchTensor& boxes, const TorchTensor& truth) {
  TorchTensor turned = truth.clone();
  turned.select(1, 6) += M_PI;
  const TorchTensor corners = corners_of(boxes);
  const auto distance = [&](const TorchTensor& other) {
    return (corners - corners_of(other)).pow(2).sum(2).add(1e-8).sqrt();
  };
  const TorchTensor nearest = torch::minimum(distance(truth).mean(1), distance(turned).mean(1));
  return torch::smooth_l1_loss(nearest, torch::zeros_like(nearest), at::Reduction::Sum, kSmoothCorner_m);
}

struct LossTensors {
  TorchTensor classes, boxes, angles, corners, shifts;
  double positives = 0.0;

  TorchTensor total() const { return classes + boxes + angles + corners + shifts; }
};

LossTensors loss_of(const TorchOutput& output, const BatchTargets& targets,
                    const NetworkArchitecture& architecture) {
  LossTensors loss;
  const TorchTensor positive = targets.class_index.ge(0).nonzero().squeeze(1);
  loss.positives = static_cast<double>(positive.size(0));
  loss.classes = class_loss(output, targets, loss.positives);
  const double per_positive = 1.0 / std::max(loss.positives, 1.0);
  const auto of_positives = [&](const TorchTensor& all) { return all.index_select(0, positive); };
  const TorchTensor codes = of_positives(output.box_codes);
  const TorchTensor bin = of_positives(targets.angle_bin);
  const DecodedPositives decoded = decode(codes, of_positives(joined(output.candidates)),
                                          of_positives(targets.class_index), bin, architecture);
  loss.boxes = per_positive * smooth(decoded.codes, of_positives(targets.codes));
  const TorchTensor bins = codes.slice(1, 6, 6 + architecture.box_code.angle_bins);
  loss.angles = per_positive * (torch::cross_entropy_loss(bins, bin, {}, at::Reduction::Sum) +
                                smooth(decoded.residual, of_positives(targets.angle_residual)));
  loss.corners = kCornerWeight * per_positive * corner_loss(decoded.boxes, of_positives(targets.boxes));
  const TorchTensor on_object = targets.is_on_object.nonzero().squeeze(1);
  loss.shifts = smooth(output.shifts.index_select(0, on_object), targets.shifts.index_select(0, on_object)) /
                std::max(static_cast<double>(on_object.size(0)), 1.0);
  return loss;
}

mlo::Tensor to_file(const TorchTensor& tensor) {
  const TorchTensor contiguous = tensor.detach().contiguous();
  mlo::Tensor stored{contiguous.sizes().vec(),
                     std::vector<float>(static_cast<std::size_t>(contiguous.numel()))};
  std::copy_n(contiguous.data_ptr<float>(), contiguous.numel(), stored.values.begin());
  return stored;
}

void from_file(const TensorFile& file, const std::string& name, TorchTensor& tensor) {
  const auto stored = file.tensors.find(name);
  if (stored == file.tensors.end() || stored->second.shape != tensor.sizes().vec()) {
    throw InputError(fmt::format(
        "the file has no tensor '{}' of the shape that is needed: it is of another network, or damaged; take "
        "another, or begin anew",
        name));
  }
  std::copy(stored->second.values.begin(), stored->second.values.end(), tensor.data_ptr<float>());
}

}  // namespace

struct Learner::Parts {
  TorchNetwork network;
  LearnerOptions options;
  std::map<std::string, TorchTensor> first_moment = {};
  std::map<std::string, TorchTensor> second_moment = {};
  long steps = 0;

  double shorten_gradients();
  void move(double learning_rate);
};

// Returns the factor by which gradients are multiplied; 0 if they are not finite.
double Learner::Parts::shorten_gradients() {
  double squared = 0.0;
  for (const auto& [name, parameter] : network.parameters()) {
    if (parameter.grad().defined()) squared += parameter.grad().pow(2).sum().item<double>();
  }
  if (!std::isfinite(squared)) return 0.0;
  return std::min(1.0, options.max_gradient / std::max(std::sqrt(squared), 1e-12));
}

// AdamW (Loshchilov and Hutter, 2019). Weights decay, biases and normalisations do not.
void Learner::Parts::move(double learning_rate) {
  const torch::NoGradGuard no_gradient;
  const double factor = shorten_gradients();
  if (factor == 0.0) return;
  ++steps;
  const double correction1 = 1.0 - std::pow(kBeta1, static_cast<double>(steps));
  const double correction2 = 1.0 - std::pow(kBeta2, static_cast<double>(steps));
  for (auto& [name, parameter] : network.parameters()) {
    if (!parameter.grad().defined()) continue;
    const TorchTensor gradient = parameter.grad() * factor;
    TorchTensor& first = first_moment.at(name);
    TorchTensor& second = second_moment.at(name);
    first.mul_(kBeta1).add_(gradient, 1.0 - kBeta1);
    second.mul_(kBeta2).addcmul_(gradient, gradient, 1.0 - kBeta2);
    if (parameter.dim() > 1) parameter.mul_(1.0 - learning_rate * options.weight_decay);
    parameter.addcdiv_(first / correction1, (second / correction2).sqrt().add_(kAdamEps), -learning_rate);
  }
}

Learner::Learner(const NetworkArchitecture& architecture, std::uint64_t seed, const LearnerOptions& options)
    : parts_(new Parts{TorchNetwork(architecture, seed), options}) {
  torch::set_num_threads(options.threads);
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(options.threads);
  for (const auto& [name, parameter] : parts_->network.parameters()) {
    parts_->first_moment[name] = torch::zeros_like(parameter.detach());
    parts_->second_moment[name] = torch::zeros_like(parameter.detach());
  }
}

Learner::~Learner() = default;

LossTerms Learner::step(std::span<const BatchExample> batch, double learning_rate) {
  for (auto& [name, parameter] : parts_->network.parameters()) parameter.mutable_grad() = TorchTensor();
  const TorchOutput output = parts_->network(batch, true);
  const NetworkArchitecture& architecture = parts_->network.architecture();
  const LossTensors loss = loss_of(output, targets_of(output, batch, architecture), architecture);
  const TorchTensor total = loss.total();
  if (std::isfinite(total.item<double>())) {
    total.backward();
    parts_->move(learning_rate);
  }
  return {loss.classes.item<double>(), loss.boxes.item<double>(),  loss.angles.item<double>(),
          loss.corners.item<double>(), loss.shifts.item<double>(), loss.positives};
}

NetworkOutput Learner::operator()(const BatchExample& example) const {
  const torch::NoGradGuard no_gradient;
  const TorchOutput output = parts_->network({&example, 1}, false);
  const auto to_rows = [](const TorchTensor& tensor) {
    const TorchTensor contiguous = tensor.contiguous();
    return RowMatrix(
        Eigen::Map<const RowMatrix>(contiguous.data_ptr<float>(), contiguous.size(0), contiguous.size(1)));
  };
  return {output.candidates.front(), to_rows(output.class_logits), to_rows(output.box_codes)};
}

TensorFile Learner::weights() const {
  TensorFile file;
  file.metadata[kFormatKey] = kFormat;
  file.metadata[kArchitectureKey] = to_json(parts_->network.architecture());
  for (const auto& [name, tensor] : parts_->network.parameters()) file.tensors[name] = to_file(tensor);
  for (const auto& [name, tensor] : parts_->network.buffers()) file.tensors[name] = to_file(tensor);
  return file;
}

TensorFile Learner::state() const {
  TensorFile file = weights();
  file.metadata[kStepsKey] = std::to_string(parts_->steps);
  for (const auto& [name, tensor] : parts_->first_moment) file.tensors[kFirstMoment + name] = to_file(tensor);
  for (const auto& [name, tensor] : parts_->second_moment)
    file.tensors[kSecondMoment + name] = to_file(tensor);
  return file;
}

void Learner::begin_with(const TensorFile& weights) {
  const torch::NoGradGuard no_gradient;
  for (auto& [name, tensor] : parts_->network.parameters()) from_file(weights, name, tensor);
  for (auto& [name, tensor] : parts_->network.buffers()) from_file(weights, name, tensor);
}

void Learner::restore(const TensorFile& state) {
  const torch::NoGradGuard no_gradient;
  const auto steps = state.metadata.find(kStepsKey);
  if (steps == state.metadata.end())
    throw InputError("the saved state does not say how many steps it has had");
  begin_with(state);
  for (auto& [name, tensor] : parts_->first_moment) from_file(state, kFirstMoment + name, tensor);
  for (auto& [name, tensor] : parts_->second_moment) from_file(state, kSecondMoment + name, tensor);
  parts_->steps = std::stol(steps->second);
}

}  // namespace mlo
