#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mlo {

/// All bytes of a file. @throws InputError when it is missing or can not be read
std::string read_file(const std::filesystem::path& path);

/// A line without its end (LF or CRLF), and the offset of the next one.
struct TextLine {
  std::string_view text;
  std::size_t next_offset = 0;
};
/// The line that begins at an offset; nothing at the end of the text.
std::optional<TextLine> line_at(std::string_view text, std::size_t offset);
/// All lines without their ends.
std::vector<std::string_view> split_lines(std::string_view text);

/// Words of a line, separated by blanks.
std::vector<std::string_view> split_words(std::string_view line);
/// Cells of a line of comma-separated values, without blanks around them.
std::vector<std::string_view> split_cells(std::string_view line);
std::string to_lower(std::string_view text);
bool is_blank(std::string_view text);

/// The number that the whole text is; nothing for anything else. Understands "nan", "inf" and what other
/// programs print for them; what a double can not hold is NaN.
std::optional<double> parse_number(std::string_view text);
/// A whole non-negative number; nothing for anything else.
std::optional<std::size_t> parse_count(std::string_view text);

}  // namespace mlo
