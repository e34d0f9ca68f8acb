#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace mlo {

/// An array of numbers, the last axis varying fastest.
struct Tensor {
  std::vector<std::int64_t> shape;  ///< empty: a single number
  std::vector<float> values;        ///< as many as the product of the shape
  bool operator==(const Tensor&) const = default;
};

/// Named arrays and what is said of them: what a safetensors file holds.
struct TensorFile {
  std::map<std::string, std::string> metadata;
  std::map<std::string, Tensor> tensors;
  bool operator==(const TensorFile&) const = default;
};

}  // namespace mlo
