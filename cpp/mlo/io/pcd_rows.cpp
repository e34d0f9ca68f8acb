#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/cloud_rows.hpp"
#include "mlo/io/lzf.hpp"
#include "mlo/io/text.hpp"

// The Point Cloud Library's format, versions 0.5 to 0.7. VIEWPOINT is not applied: points stay as the sensor
// gave them.
namespace mlo {
namespace {

constexpr std::size_t kMaxCount = 1'000'000;  // numbers in one field
constexpr std::size_t kSizesBytes = 8;        // in front of compressed points: their two sizes
constexpr std::size_t kMaxLzfRatio = 132;     // two or three bytes stand for 264 at most

struct PcdHeader {
  std::vector<Column> columns;
  std::size_t points = 0;
  std::string encoding;  ///< ascii, binary or binary_compressed
  std::size_t data_offset = 0;
  std::size_t lines = 0;

  std::size_t row_size() const {
    std::size_t size = 0;
    for (const Column& column : columns) size += size_of(column.type) * column.count;
    return size;
  }
};

/// A line of the header: what stands behind its keyword.
struct Entry {
  std::vector<std::string_view> values;
  std::size_t line = 0;
};
using Entries = std::map<std::string, Entry, std::less<>>;

class HeaderError {
 public:
  explicit HeaderError(const std::filesystem::path& path) : path_(path) {}
  [[noreturn]] void operator()(std::size_t line, const std::string& problem) const {
    throw InputError(
        fmt::format("{}:{}: {}; write the file again as PCD version 0.7", path_.string(), line, problem));
  }

 private:
  const std::filesystem::path& path_;
};

Entries read_entries(std::string_view bytes, PcdHeader& header, const HeaderError& fail) {
  Entries entries;
  while (!entries.contains("DATA")) {
    const auto line = line_at(bytes, header.data_offset);
    if (!line) fail(header.lines, "the header ends without a line DATA");
    ++header.lines;
    header.data_offset = line->next_offset;
    std::vector<std::string_view> words = split_words(line->text);
    if (words.empty() || words[0].starts_with('#')) continue;
    const std::string keyword(words[0] == "COLUMNS" ? "FIELDS" : words[0]);  // the name in version 0.5
    constexpr std::string_view kKeywords[] = {"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                              "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
    if (std::find(std::begin(kKeywords), std::end(kKeywords), keyword) == std::end(kKeywords)) {
      fail(header.lines, "this is no line of a PCD header");
    }
    words.erase(words.begin());
    entries[keyword] = {std::move(words), header.lines};
  }
  return entries;
}

ScalarType scalar_type(std::string_view type, std::string_view size, std::size_t line,
                       const HeaderError& fail) {
  constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"I1", ScalarType::int8},   {"U1", ScalarType::uint8},  {"I2", ScalarType::int16},
      {"U2", ScalarType::uint16}, {"I4", ScalarType::int32},  {"U4", ScalarType::uint32},
      {"I8", ScalarType::int64},  {"U8", ScalarType::uint64}, {"F4", ScalarType::float32},
      {"F8", ScalarType::float64}};
  const std::string name = std::string(type) + std::string(size);
  for (const auto& [known, value] : kTypes) {
    if (known == name) return value;
  }
  fail(line, fmt::format("there is no type {} of size {}", type, size));
}

std::vector<Column> columns_of(const Entries& entries, const HeaderError& fail) {
  for (const std::string_view required : {"FIELDS", "SIZE", "TYPE"}) {
    if (!entries.contains(required)) {
      fail(entries.at("DATA").line, fmt::format("the header has no line {}", required));
    }
  }
  const std::vector<std::string_view>& names = entries.at("FIELDS").values;
  for (const std::string_view keyword : {"SIZE", "TYPE", "COUNT"}) {
    const auto entry = entries.find(keyword);
    if (entry == entries.end() || entry->second.values.size() == names.size()) continue;
    fail(entry->second.line,
         fmt::format("{} has {} values for {} fields", keyword, entry->second.values.size(), names.size()));
  }
  std::vector<Column> columns;
  for (std::size_t i = 0; i < names.size(); ++i) {
    Column& column = columns.emplace_back();
    column.name = names[i];
    const Entry& sizes = entries.at("SIZE");
    column.type = scalar_type(entries.at("TYPE").values[i], sizes.values[i], sizes.line, fail);
    const auto counts = entries.find("COUNT");
    if (counts == entries.end()) continue;
    const auto count = parse_count(counts->second.values[i]);
    if (!count || *count > kMaxCount)
      fail(counts->second.line, fmt::format("'{}' is no count", counts->second.values[i]));
    column.count = *count;
  }
  return columns;
}

/// The one number behind a keyword; nothing where the header does not have it.
std::optional<std::size_t> number_of(const Entries& entries, std::string_view keyword,
                                     const HeaderError& fail) {
  const auto entry = entries.find(keyword);
  if (entry == entries.end()) return std::nullopt;
  const auto& values = entry->second.values;
  const auto number = values.size() == 1 ? parse_count(values[0]) : std::nullopt;
  if (!number) fail(entry->second.line, fmt::format("{} needs one whole number", keyword));
  return number;
}

std::size_t points_of(const Entries& entries, const HeaderError& fail) {
  const auto points = number_of(entries, "POINTS", fail);
  const auto width = number_of(entries, "WIDTH", fail);
  const std::size_t height = number_of(entries, "HEIGHT", fail).value_or(1);
  if (!points && !width) fail(entries.at("DATA").line, "the header has neither POINTS nor WIDTH");
  if (!width) return *points;
  if (height != 0 && *width > std::numeric_limits<std::uint32_t>::max() / height) {
    fail(entries.at("WIDTH").line, "WIDTH x HEIGHT is too large");
  }
  if (points && *points != *width * height) {
    fail(entries.at("POINTS").line,
         fmt::format("POINTS {} is not WIDTH x HEIGHT, {} x {}", *points, *width, height));
  }
  return *width * height;
}

PcdHeader read_pcd_header(const std::filesystem::path& path, std::string_view bytes) {
  const HeaderError fail(path);
  PcdHeader header;
  const Entries entries = read_entries(bytes, header, fail);
  header.columns = columns_of(entries, fail);
  header.points = points_of(entries, fail);
  const Entry& data = entries.at("DATA");
  if (data.values.size() == 1) header.encoding = data.values[0];
  if (header.encoding != "ascii" && header.encoding != "binary" && header.encoding != "binary_compressed") {
    fail(data.line, "DATA must be ascii, binary or binary_compressed");
  }
  return header;
}

/// Compressed points are stored field by field; gives them point by point, as in a binary file.
std::string decompressed_rows(const std::filesystem::path& path, std::string_view bytes,
                              const PcdHeader& header) {
  const auto error = [&](std::string_view problem) {
    return InputError(
        fmt::format("{}: byte {}: {}; the file is damaged or incomplete, copy or convert it again",
                    path.string(), header.data_offset, problem));
  };
  const std::string_view data = bytes.substr(header.data_offset);
  if (data.size() < kSizesBytes) throw error("the sizes of the compressed points are missing");
  const auto size_at = [data](std::size_t offset) {
    return static_cast<std::size_t>(
        load_scalar(data.data() + offset, ScalarType::uint32, std::endian::little));
  };
  const std::size_t compressed_size = size_at(0);
  const std::size_t size = size_at(4);
  if (compressed_size > data.size() - kSizesBytes) throw error("the compressed points are cut off");
  if (size / kMaxLzfRatio > compressed_size) throw error("so few bytes can not hold the points");
  if (size != header.points * header.row_size())
    throw error("the size of the points is not that of the header");
  const auto columns = lzf_decompress(data.substr(kSizesBytes, compressed_size), size);
  if (!columns) throw error("the points do not decompress");

  std::string rows(size, '\0');
  std::size_t source = 0;
  std::size_t offset_in_row = 0;
  for (const Column& column : header.columns) {
    const std::size_t width = size_of(column.type) * column.count;
    for (std::size_t i = 0; i < header.points; ++i, source += width) {
      std::copy_n(columns->data() + source, width, rows.data() + i * header.row_size() + offset_in_row);
    }
    offset_in_row += width;
  }
  return rows;
}

}  // namespace

void read_pcd_rows(const std::filesystem::path& path, std::string_view bytes, const RowSink& sink) {
  const PcdHeader header = read_pcd_header(path, bytes);
  if (header.encoding == "ascii") {
    TextCursor cursor(path, bytes, header.data_offset, header.lines);
    read_points(cursor, header.columns, header.points, sink, path);
  } else if (header.encoding == "binary") {
    BinaryCursor cursor(path, bytes, header.data_offset, std::endian::little);
    read_points(cursor, header.columns, header.points, sink, path);
  } else {
    const std::string rows = header.points == 0 ? "" : decompressed_rows(path, bytes, header);
    BinaryCursor cursor(path, rows, 0, std::endian::little);
    read_points(cursor, header.columns, header.points, sink, path);
  }
}

}  // namespace mlo
