#include "mlo/io/text.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <limits>
#include <system_error>

#include <fmt/format.h>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

constexpr std::string_view kBlanks = " \t\r\f\v";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  text.remove_prefix(begin);
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) {
    throw InputError(fmt::format("{}: cannot be opened; check the path and the permissions", path.string()));
  }
  std::string bytes(size, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(size));
  if (file.gcount() == static_cast<std::streamsize>(size)) return bytes;
  throw InputError(fmt::format("{}: only {} of its {} bytes can be read; check the disk or copy it again",
                               path.string(), file.gcount(), size));
}

std::optional<TextLine> line_at(std::string_view text, std::size_t offset) {
  if (offset >= text.size()) return std::nullopt;
  const std::size_t end = std::min(text.find('\n', offset), text.size());
  TextLine line{text.substr(offset, end - offset), std::min(end + 1, text.size())};
  if (line.text.ends_with('\r')) line.text.remove_suffix(1);
  return line;
}

std::vector<std::string_view> split_lines(std::string_view text) {
  std::vector<std::string_view> lines;
  std::size_t offset = 0;
  while (const std::optional<TextLine> line = line_at(text, offset)) {
    lines.push_back(line->text);
    offset = line->next_offset;
  }
  return lines;
}

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return words;
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

std::vector<std::string_view> split_cells(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

std::string to_lower(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

bool is_blank(std::string_view text) {
  return text.find_first_not_of(kBlanks) == std::string_view::npos;
}

std::optional<double> parse_number(std::string_view text) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  // "1.#QNAN", "-1.#IND", "1.#INF": older Microsoft runtimes
  if (text.starts_with("1.#") || text.starts_with("-1.#")) return kNan;
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stopped_at, error] = std::from_chars(text.data(), end, value);
  if (stopped_at != end || error == std::errc::invalid_argument) return std::nullopt;
  return error == std::errc() ? value : kNan;
}

std::optional<std::size_t> parse_count(std::string_view text) {
  std::size_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped_at, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stopped_at != end) return std::nullopt;
  return value;
}

}  // namespace mlo
