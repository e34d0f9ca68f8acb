#include "mlo/io/text_table.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  std::size_t begin = line.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
  return fields;
}

template <class Number>
bool parse(std::string_view text, Number& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

double TextRow::number(std::size_t field) const {
  double value = 0.0;
  if (!parse(fields_[field], value) || !std::isfinite(value)) {
    fail(fmt::format("field {} is '{}', not a finite number", field + 1, fields_[field]));
  }
  return value;
}

long TextRow::integer(std::size_t field) const {
  long value = 0;
  if (!parse(fields_[field], value)) {
    fail(fmt::format("field {} is '{}', not a whole number", field + 1, fields_[field]));
  }
  return value;
}

void TextRow::fail(std::string_view problem) const {
  throw InputError(fmt::format("{}:{}: {}", *path_, line_, problem));
}

TextTable::TextTable(const std::filesystem::path& path) : path_(path.string()) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream buffer;
  if (std::filesystem::is_directory(path) || !file || !(file.peek() == EOF || buffer << file.rdbuf())) {
    throw InputError(fmt::format("{}: cannot be read; check that it is a readable text file", path_));
  }
  content_ = std::move(buffer).str();
  std::size_t line_number = 0;
  for (std::size_t begin = 0; begin < content_.size();) {
    const std::size_t end = std::min(content_.find('\n', begin), content_.size());
    ++line_number;
    std::vector<std::string_view> fields = split(std::string_view(content_).substr(begin, end - begin));
    if (!fields.empty() && !fields.front().starts_with('#')) {
      rows_.emplace_back(path_, line_number, std::move(fields));
    }
    begin = end + 1;
  }
}

}  // namespace mlo
