#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mlo {

/// A line of a text file, split at white space. Valid as long as its table.
class TextRow {
 public:
  TextRow(const std::string& path, std::size_t line, std::vector<std::string_view> fields)
      : path_(&path), line_(line), fields_(std::move(fields)) {}

  std::size_t size() const { return fields_.size(); }
  std::size_t line() const { return line_; }
  std::string_view text(std::size_t field) const { return fields_[field]; }
  /// @throws InputError naming file, line and field if that is not a finite number
  double number(std::size_t field) const;
  /// @throws InputError naming file, line and field if that is not a whole number
  long integer(std::size_t field) const;
  /// Ends reading with "file:line: problem".
  [[noreturn]] void fail(std::string_view problem) const;

 private:
  const std::string* path_;
  std::size_t line_;
  std::vector<std::string_view> fields_;
};

/// The rows of a text file that are neither blank nor comments (#), with their line numbers.
class TextTable {
 public:
  /// @throws InputError if the file cannot be read
  explicit TextTable(const std::filesystem::path& path);
  TextTable(const TextTable&) = delete;
  TextTable& operator=(const TextTable&) = delete;

  std::span<const TextRow> rows() const { return rows_; }

 private:
  std::string path_;
  std::string content_;
  std::vector<TextRow> rows_;
};

}  // namespace mlo
