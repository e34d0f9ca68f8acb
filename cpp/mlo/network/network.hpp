#pragma once

#include <vector>

#include "mlo/core/tensor_file.hpp"
#include "mlo/network/architecture.hpp"
#include "mlo/network/point_operations.hpp"

namespace mlo {

/// What the network is asked: points in the frame of its input (NetworkInputSpec), and what is known of each.
struct NetworkInput {
  PointRows points;
  RowMatrix features;  ///< a column for each feature of the architecture
};

/// What the network answers: per candidate, a row.
struct NetworkOutput {
  PointRows candidates;  ///< shifted towards the centre of what they may be on
  RowMatrix class_logits;
  RowMatrix box_codes;  ///< BoxCodeSpec
};

/// Layers that are applied one after the other: y = W x + b, then max(y, 0). Batch normalisation is part of W
/// and b.
struct DenseLayer {
  RowMatrix weight;  ///< outputs x inputs
  Eigen::RowVectorXf bias;
  bool rectified = true;

  RowMatrix operator()(const RowMatrix& rows) const;
};
using DenseSequence = std::vector<DenseLayer>;

/// Inference of 3DSSD on the CPU. Immutable; runs on the caller's TBB arena; the same output for any number
/// of threads.
class Network {
 public:
  /// @throws InputError if a tensor is missing, has another shape than the architecture says, or is not
  /// finite
  explicit Network(const TensorFile& file);

  const NetworkArchitecture& architecture() const { return architecture_; }

  /// @param input  finite; without points there are no candidates
  NetworkOutput operator()(const NetworkInput& input) const;

 private:
  struct Layer {
    std::vector<DenseSequence> scales;
    DenseSequence aggregate;
  };
  RowMatrix describe(const PointRows& points, const RowMatrix& features, const PointRows& centers,
                     const SetAbstractionSpec& spec, const Layer& layer) const;

  NetworkArchitecture architecture_;
  std::vector<Layer> layers_;
  Layer candidates_;
  DenseSequence vote_, shared_, classes_, boxes_;
};

/// Which of a layer's input points become its centres.
std::vector<std::uint32_t> sample(const PointRows& points, const RowMatrix& features,
                                  const std::vector<SamplingSpec>& samples);

/// The candidates' shifts, each coordinate limited.
PointRows limited_shifts(const RowMatrix& shifts, const Eigen::Vector3d& max_shift_m);

}  // namespace mlo
