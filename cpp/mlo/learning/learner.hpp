#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "mlo/core/tensor_file.hpp"
#include "mlo/learning/batch.hpp"
#include "mlo/network/architecture.hpp"

namespace mlo {

/// The parts of the loss (3DSSD, section 3.4), each as it enters the sum.
struct LossTerms {
  double classes = 0.0;    ///< cross-entropy with centre-ness as label, over the number of positives
  double boxes = 0.0;      ///< smooth L1 of centre and size
  double angles = 0.0;     ///< cross-entropy of the bin, smooth L1 within it
  double corners = 0.0;    ///< distance of the eight corners
  double shifts = 0.0;     ///< smooth L1 of the candidates' shifts
  double positives = 0.0;  ///< candidates that lie in an object

  double total() const { return classes + boxes + angles + corners + shifts; }
};

struct LearnerOptions {
  double weight_decay = 0.01;
  double max_gradient = 10.0;  ///< the gradient is shortened to this norm
  int threads = 1;             ///< of LibTorch: other numbers may round differently
};

/// A network that learns, by LibTorch: AdamW on the loss of 3DSSD.
class Learner {
 public:
  /// Begins with random parameters, the same for the same seed.
  Learner(const NetworkArchitecture& architecture, std::uint64_t seed, const LearnerOptions& options);
  ~Learner();
  Learner(const Learner&) = delete;
  Learner& operator=(const Learner&) = delete;

  /// One step on a batch; what the loss was before it. A batch whose loss is not finite moves no parameter.
  LossTerms step(std::span<const BatchExample> batch, double learning_rate);

  /// What the network answers as it is, normalised by its running statistics: the same as Network, up to
  /// rounding.
  NetworkOutput operator()(const BatchExample& example) const;

  /// Takes the weights of a file of the same architecture instead of random ones.
  /// @throws InputError if a tensor is missing or of another shape
  void begin_with(const TensorFile& weights);
  /// For Network.
  TensorFile weights() const;
  /// Weights, optimiser and number of steps: a learner that takes them goes on with the same bytes.
  TensorFile state() const;
  /// @throws InputError if they are not of such a network
  void restore(const TensorFile& state);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace mlo
