#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/cloud_rows.hpp"
#include "mlo/io/text.hpp"

// The Stanford polygon format, version 1.0. Points are the element "vertex".
namespace mlo {
namespace {

struct Element {
  std::string name;
  std::size_t rows = 0;
  std::vector<Column> columns;
};

enum class PlyEncoding { ascii, binary_little_endian, binary_big_endian };

struct PlyHeader {
  std::optional<PlyEncoding> encoding;
  std::vector<Element> elements;
  std::size_t data_offset = 0;
  std::size_t lines = 0;
};

[[noreturn]] void fail(const std::filesystem::path& path, std::size_t line, const std::string& problem) {
  throw InputError(fmt::format("{}:{}: {}; write the file again as PLY 1.0", path.string(), line, problem));
}

std::optional<ScalarType> scalar_type(std::string_view name) {
  constexpr std::pair<std::string_view, ScalarType> kNames[] = {
      {"char", ScalarType::int8},     {"uchar", ScalarType::uint8},     {"short", ScalarType::int16},
      {"ushort", ScalarType::uint16}, {"int", ScalarType::int32},       {"uint", ScalarType::uint32},
      {"float", ScalarType::float32}, {"double", ScalarType::float64},  {"int8", ScalarType::int8},
      {"uint8", ScalarType::uint8},   {"int16", ScalarType::int16},     {"uint16", ScalarType::uint16},
      {"int32", ScalarType::int32},   {"uint32", ScalarType::uint32},   {"int64", ScalarType::int64},
      {"uint64", ScalarType::uint64}, {"float32", ScalarType::float32}, {"float64", ScalarType::float64}};
  for (const auto& [known, type] : kNames) {
    if (known == name) return type;
  }
  return std::nullopt;
}

using Words = std::vector<std::string_view>;

std::optional<PlyEncoding> parse_encoding(const Words& words) {
  if (words.size() != 3 || words[2] != "1.0") return std::nullopt;
  if (words[1] == "ascii") return PlyEncoding::ascii;
  if (words[1] == "binary_little_endian") return PlyEncoding::binary_little_endian;
  if (words[1] == "binary_big_endian") return PlyEncoding::binary_big_endian;
  return std::nullopt;
}

std::optional<Element> parse_element(const Words& words) {
  const auto rows = words.size() == 3 ? parse_count(words[2]) : std::nullopt;
  if (!rows) return std::nullopt;
  return Element{std::string(words[1]), *rows, {}};
}

/// "property TYPE NAME" or "property list LENGTH_TYPE TYPE NAME".
std::optional<Column> parse_property(const Words& words) {
  const bool is_list = words.size() == 5 && words[1] == "list";
  if (!is_list && words.size() != 3) return std::nullopt;
  const auto type = scalar_type(words[words.size() - 2]);
  const auto length_type = is_list ? scalar_type(words[2]) : std::nullopt;
  if (!type || (is_list && !length_type)) return std::nullopt;
  Column column;
  column.name = words.back();
  column.type = *type;
  column.list_length = length_type;
  return column;
}

/// Takes one line of the header; false if it can not be understood.
bool take_line(const Words& words, PlyHeader& header) {
  if (words[0] == "comment" || words[0] == "obj_info") return true;
  if (words[0] == "format") return (header.encoding = parse_encoding(words)).has_value();
  if (words[0] == "element") {
    const auto element = parse_element(words);
    if (element) header.elements.push_back(*element);
    return element.has_value();
  }
  if (words[0] == "property" && !header.elements.empty()) {
    const auto property = parse_property(words);
    if (property) header.elements.back().columns.push_back(*property);
    return property.has_value();
  }
  return false;
}

PlyHeader read_ply_header(const std::filesystem::path& path, std::string_view bytes) {
  PlyHeader header;
  for (;;) {
    const auto line = line_at(bytes, header.data_offset);
    if (!line) fail(path, header.lines, "the header ends without a line end_header");
    ++header.lines;
    header.data_offset = line->next_offset;
    const Words words = split_words(line->text);
    if (header.lines == 1) {
      if (words != Words{"ply"}) fail(path, 1, "the file does not begin with a line 'ply'");
      continue;
    }
    if (words == Words{"end_header"}) break;
    if (!words.empty() && !take_line(words, header)) {
      fail(path, header.lines, fmt::format("'{}' can not be understood", line->text.substr(0, 80)));
    }
  }
  if (!header.encoding) fail(path, header.lines, "the header has no line format");
  return header;
}

/// Reads over the elements in front of the points, then the points; what follows is of no interest.
template <class Cursor>
void read_elements(Cursor cursor, const PlyHeader& header, const std::filesystem::path& path,
                   const RowSink& sink) {
  for (const Element& element : header.elements) {
    if (element.name == "vertex") return read_points(cursor, element.columns, element.rows, sink, path);
    if (element.columns.empty()) continue;
    cursor.expect_rows(element.rows, element.columns);
    read_rows(cursor, element.columns, element.rows, [](const RoleValues&) {});
  }
  fail(path, header.lines, "the header has no element vertex");
}

}  // namespace

void read_ply_rows(const std::filesystem::path& path, std::string_view bytes, const RowSink& sink) {
  const PlyHeader header = read_ply_header(path, bytes);
  if (header.encoding == PlyEncoding::ascii) {
    read_elements(TextCursor(path, bytes, header.data_offset, header.lines), header, path, sink);
    return;
  }
  const bool big = header.encoding == PlyEncoding::binary_big_endian;
  const std::endian order = big ? std::endian::big : std::endian::little;
  read_elements(BinaryCursor(path, bytes, header.data_offset, order), header, path, sink);
}

}  // namespace mlo
