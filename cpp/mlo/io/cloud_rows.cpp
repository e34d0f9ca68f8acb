#include "mlo/io/cloud_rows.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

struct KnownName {
  std::string_view name;
  Role role;
};
/// The first that a file has takes the role.
constexpr KnownName kKnownNames[] = {
    {"x", Role::x},
    {"y", Role::y},
    {"z", Role::z},
    {"intensity", Role::intensity},
    {"i", Role::intensity},
    {"reflectivity", Role::intensity},
    {"reflectance", Role::intensity},
    {"remission", Role::intensity},
    {"time", Role::time},
    {"t", Role::time},
    {"timestamp", Role::time},
    {"time_stamp", Role::time},
    {"time_offset", Role::time},
    {"offset_time", Role::time},
    {"ring", Role::ring},
    {"channel", Role::ring},
    {"line", Role::ring},
    {"label", Role::label},
    {"classification", Role::label},
    {"class", Role::label},
};

std::string plain_name(std::string_view name) {
  const std::string lower = to_lower(name);
  constexpr std::string_view kPrefix = "scalar_";
  return lower.starts_with(kPrefix) ? lower.substr(kPrefix.size()) : lower;
}

Column* find_column(std::vector<Column>& columns, std::string_view name) {
  const auto found = std::find_if(columns.begin(), columns.end(), [name](const Column& column) {
    return column.count == 1 && !column.list_length && plain_name(column.name) == name;
  });
  return found == columns.end() ? nullptr : &*found;
}

[[noreturn]] void fail_at_line(const std::filesystem::path& path, std::size_t line,
                               const std::string& problem) {
  throw InputError(
      fmt::format("{}:{}: {}; the file is damaged, copy or convert it again", path.string(), line, problem));
}

std::optional<std::size_t> as_length(double value) {
  constexpr double kLongestList = 1e9;
  if (!(value >= 0.0 && value <= kLongestList) || value != std::floor(value)) return std::nullopt;
  return static_cast<std::size_t>(value);
}

}  // namespace

CloudFields assign_roles(std::vector<Column>& columns, const std::filesystem::path& path) {
  CloudFields fields;
  for (const KnownName& known : kKnownNames) {
    Column* const column = find_column(columns, known.name);
    if (column == nullptr || fields.has(known.role)) continue;
    // s and t together are the coordinates of a texture
    if (known.name == "t" && find_column(columns, "s") != nullptr) continue;
    column->role = known.role;
    fields.present[index_of(known.role)] = true;
    if (known.role == Role::time) fields.integer_time = is_integer(column->type);
  }
  if (fields.has(Role::x) && fields.has(Role::y) && fields.has(Role::z)) return fields;
  std::string names;
  for (const Column& column : columns) names += ' ' + column.name;
  throw InputError(fmt::format("{}: points have no x, y and z, only:{}; write them with these names",
                               path.string(), names.empty() ? " nothing" : names));
}

const char* BinaryCursor::take(std::size_t size) {
  if (size > bytes_.size() - offset_) {
    throw InputError(
        fmt::format("{}: ends at byte {} in the middle of the points; the file is incomplete, copy "
                    "or convert it again",
                    path_.string(), bytes_.size()));
  }
  const char* const data = bytes_.data() + offset_;
  offset_ += size;
  return data;
}

double BinaryCursor::next(ScalarType type) {
  return load_scalar(take(size_of(type)), type, order_);
}

std::size_t BinaryCursor::next_length(ScalarType type) {
  const std::size_t at = offset_;
  if (const auto length = as_length(next(type))) return *length;
  throw InputError(
      fmt::format("{}: byte {}: a list has a length that is no count; the file is damaged, copy or "
                  "convert it again",
                  path_.string(), at));
}

void BinaryCursor::skip(ScalarType type, std::size_t count) {
  take(size_of(type) * count);
}

void BinaryCursor::expect_rows(std::size_t rows, const std::vector<Column>& columns) const {
  std::size_t row_size = 0;
  for (const Column& column : columns) {
    row_size += column.list_length ? size_of(*column.list_length) : size_of(column.type) * column.count;
  }
  const std::size_t left = bytes_.size() - offset_;
  if (row_size == 0 || rows <= left / row_size) return;
  throw InputError(
      fmt::format("{}: announces {} rows of {} bytes, but only {} bytes follow from byte {} on; the "
                  "file is incomplete, copy or convert it again",
                  path_.string(), rows, row_size, left, offset_));
}

void TextCursor::begin_row() {
  do {
    const auto line = line_at(bytes_, offset_);
    if (!line) fail_at_line(path_, line_number_, "the file ends here, though more points were announced");
    ++line_number_;
    words_ = split_words(line->text);
    next_word_ = 0;
    offset_ = line->next_offset;
  } while (words_.empty());
}

void TextCursor::end_row() const {
  if (next_word_ == words_.size()) return;
  fail_at_line(path_, line_number_, "has more values than the header announces");
}

std::string_view TextCursor::next_word() {
  if (next_word_ == words_.size()) {
    fail_at_line(path_, line_number_, "has fewer values than the header announces");
  }
  return words_[next_word_++];
}

double TextCursor::next(ScalarType) {
  const std::string_view word = next_word();
  if (const auto value = parse_number(word)) return *value;
  fail_at_line(path_, line_number_, fmt::format("'{}' is not a number", word));
}

std::size_t TextCursor::next_length(ScalarType type) {
  if (const auto length = as_length(next(type))) return *length;
  fail_at_line(path_, line_number_, "a list has a length that is no count");
}

void TextCursor::skip(ScalarType, std::size_t count) {
  for (; count > 0; --count) next_word();
}

void TextCursor::expect_rows(std::size_t rows, const std::vector<Column>&) const {
  if (rows <= bytes_.size() - offset_) return;  // a row takes a byte at least
  fail_at_line(path_, line_number_,
               fmt::format("announces {} rows, but only {} bytes follow", rows, bytes_.size() - offset_));
}

void read_cloud_rows(const std::filesystem::path& path, const RowSink& sink) {
  const std::string extension = to_lower(path.extension().string());
  if (extension != ".pcd" && extension != ".ply") {
    throw InputError(fmt::format("{}: is no .pcd or .ply file; convert it to one of them", path.string()));
  }
  const std::string bytes = read_file(path);
  if (extension == ".pcd") {
    read_pcd_rows(path, bytes, sink);
  } else {
    read_ply_rows(path, bytes, sink);
  }
}

Eigen::Vector3f position_of(const RoleValues& row) {
  return {static_cast<float>(row[index_of(Role::x)]), static_cast<float>(row[index_of(Role::y)]),
          static_cast<float>(row[index_of(Role::z)])};
}

}  // namespace mlo
