#include <algorithm>

#include <fmt/format.h>

#include "mlo/reproduction/reproduce.hpp"

namespace mlo {
namespace {

using Values = std::vector<std::optional<double>>;

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

std::string joined(const Values& values, const char* instead_of_none) {
  std::vector<std::string> words;
  for (const std::optional<double>& value : values) {
    words.push_back(value ? fmt::format("{:.2f}", *value) : instead_of_none);
  }
  return joined(words, " / ");
}

std::vector<std::string> cells_of(const ReproducedRow& row) {
  std::vector<std::string> cells{row.paper.name};
  for (const Values& values : row.paper.values) cells.push_back(joined(values, "fail"));
  for (const Values& values : row.here) cells.push_back(values.empty() ? "-" : joined(values, "-"));
  cells.push_back(row.note);
  return cells;
}

std::string aligned(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths;
  for (const auto& line : lines) {
    widths.resize(std::max(widths.size(), line.size()));
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  }
  std::string text;
  for (const auto& line : lines) {
    std::string row;
    for (std::size_t i = 0; i < line.size(); ++i) row += fmt::format("{:<{}}  ", line[i], widths[i]);
    text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace

std::string to_text(const ReproducedTable& table) {
  std::vector<std::string> head{joined(table.paper.measures, " / ")};
  for (const std::string& method : table.paper.methods) head.push_back("paper: " + method);
  head.insert(head.end(), table.titles.begin(), table.titles.end());
  std::vector<std::vector<std::string>> lines{head};
  for (const ReproducedRow& row : table.rows) lines.push_back(cells_of(row));
  std::string text = fmt::format("{}: {}\n{}", table.paper.name, table.paper.caption, aligned(lines));
  if (!table.paper.note.empty()) text += table.paper.note + "\n";
  if (!table.missing.empty()) {
    text += fmt::format("missing: {} of {} rows have no data: {}\n", table.missing.size(),
                        table.paper.rows.size(), joined(table.missing, ", "));
  }
  return text;
}

}  // namespace mlo
