#pragma once

#include <span>
#include <string>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/tensor_file.hpp"
#include "mlo/learning/training.hpp"

namespace mlo {

/// The course of a training as a table with a header line, and as diagrams (SVG).
std::string curves_csv(std::span<const TrainingRow> rows, std::span<const ObjectClass> classes);
std::string curves_svg(std::span<const TrainingRow> rows, std::span<const ObjectClass> classes);

/// The same as numbers, for the saved state, and back.
Tensor to_tensor(std::span<const TrainingRow> rows);
std::vector<TrainingRow> rows_from(const Tensor& tensor);

}  // namespace mlo
