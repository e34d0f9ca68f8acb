#include "mlo/learning/curves.hpp"

#include <array>

#include <fmt/format.h>

#include "mlo/evaluation/plot.hpp"

namespace mlo {
namespace {

struct Term {
  const char* name;
  double LossTerms::*value;
};
constexpr std::array kTerms{Term{"classes", &LossTerms::classes}, Term{"boxes", &LossTerms::boxes},
                            Term{"angles", &LossTerms::angles},   Term{"corners", &LossTerms::corners},
                            Term{"shifts", &LossTerms::shifts},   Term{"positives", &LossTerms::positives}};
constexpr std::size_t kLossTerms = 5;                     // of them: all but the positives
constexpr std::size_t kFixedColumns = 2 + kTerms.size();  // step and learning rate before them

}  // namespace

std::string curves_csv(std::span<const TrainingRow> rows, std::span<const ObjectClass> classes) {
  std::string text = "step,learning_rate";
  for (const Term& term : kTerms) text += fmt::format(",{}", term.name);
  for (const ObjectClass object_class : classes) text += fmt::format(",ap_{}", to_string(object_class));
  text += '\n';
  for (const TrainingRow& row : rows) {
    text += fmt::format("{},{:.6g}", row.step, row.learning_rate);
    for (const Term& term : kTerms) text += fmt::format(",{:.5g}", row.loss.*term.value);
    for (std::size_t k = 0; k < classes.size(); ++k) {
      text += k < row.ap.size() ? fmt::format(",{:.4f}", row.ap[k]) : ",";
    }
    text += '\n';
  }
  return text;
}

std::string curves_svg(std::span<const TrainingRow> rows, std::span<const ObjectClass> classes) {
  std::vector<PlotPanel> panels{{"Loss", "step", "mean since the point before", false, {}},
                                {"Average precision on the validation scans", "step", "AP", false, {}}};
  for (std::size_t k = 0; k < kLossTerms; ++k) panels[0].curves.push_back({kTerms[k].name, k + 1, {}});
  for (std::size_t k = 0; k < classes.size(); ++k) {
    panels[1].curves.push_back({std::string(to_string(classes[k])), k + 1, {}});
  }
  for (const TrainingRow& row : rows) {
    const auto step = static_cast<double>(row.step);
    for (std::size_t k = 0; k < kLossTerms; ++k) {
      panels[0].curves[k].points.emplace_back(step, row.loss.*kTerms[k].value);
    }
    for (std::size_t k = 0; k < row.ap.size(); ++k) panels[1].curves[k].points.emplace_back(step, row.ap[k]);
  }
  if (rows.empty() || rows.front().ap.empty()) panels.pop_back();
  return svg_plot(panels);
}

Tensor to_tensor(std::span<const TrainingRow> rows) {
  const std::size_t classes = rows.empty() ? 0 : rows.front().ap.size();
  Tensor tensor{{static_cast<std::int64_t>(rows.size()), static_cast<std::int64_t>(kFixedColumns + classes)},
                {}};
  for (const TrainingRow& row : rows) {
    tensor.values.push_back(static_cast<float>(row.step));
    tensor.values.push_back(static_cast<float>(row.learning_rate));
    for (const Term& term : kTerms) tensor.values.push_back(static_cast<float>(row.loss.*term.value));
    for (const double ap : row.ap) tensor.values.push_back(static_cast<float>(ap));
  }
  return tensor;
}

std::vector<TrainingRow> rows_from(const Tensor& tensor) {
  std::vector<TrainingRow> rows;
  if (tensor.shape.size() != 2 || tensor.shape[1] < static_cast<std::int64_t>(kFixedColumns)) return rows;
  const auto columns = static_cast<std::size_t>(tensor.shape[1]);
  for (std::size_t at = 0; at + columns <= tensor.values.size(); at += columns) {
    TrainingRow row;
    row.step = static_cast<long>(tensor.values[at]);
    row.learning_rate = static_cast<double>(tensor.values[at + 1]);
    for (std::size_t k = 0; k < kTerms.size(); ++k) {
      row.loss.*kTerms[k].value = static_cast<double>(tensor.values[at + 2 + k]);
    }
    for (std::size_t k = kFixedColumns; k < columns; ++k) {
      row.ap.push_back(static_cast<double>(tensor.values[at + k]));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace mlo
