#include "mlo/io/text_records.hpp"

#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

// Takes a number from the front of the text; false if there is none.
template <class Number>
bool take(std::string_view& text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool take(std::string_view& text, char expected) {
  if (text.empty() || text.front() != expected) return false;
  text.remove_prefix(1);
  return true;
}

// "yyyy-mm-dd hh:mm:ss.fraction".
std::optional<double> parse_date_s(std::string_view text) {
  int year = 0;
  unsigned month = 0;
  unsigned day = 0;
  int hour = 0;
  int minute = 0;
  double second = 0.0;
  const bool well_formed = take(text, year) && take(text, '-') && take(text, month) && take(text, '-') &&
                           take(text, day) && take(text, ' ') && take(text, hour) && take(text, ':') &&
                           take(text, minute) && take(text, ':') && take(text, second) && text.empty();
  const std::chrono::year_month_day date{std::chrono::year{year}, std::chrono::month{month},
                                         std::chrono::day{day}};
  if (!well_formed || !date.ok()) return std::nullopt;
  const auto days = std::chrono::sys_days{date}.time_since_epoch().count();
  return static_cast<double>(days) * 86400.0 + hour * 3600 + minute * 60 + second;
}

}  // namespace

std::vector<std::string> read_lines(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  const std::vector<std::string_view> views = split_lines(text);
  std::vector<std::string> lines(views.begin(), views.end());
  while (!lines.empty() && is_blank(lines.back())) lines.pop_back();
  return lines;
}

std::vector<double> parse_numbers(std::string_view line, std::string_view where) {
  std::vector<double> numbers;
  for (const std::string_view word : split_words(line)) {
    const std::optional<double> value = parse_number(word);
    if (!value || !std::isfinite(*value)) {
      throw InputError(fmt::format("{}: '{}' is not a finite number", where, word));
    }
    numbers.push_back(*value);
  }
  return numbers;
}

double parse_stamp_s(std::string_view text, std::string_view where) {
  const std::vector<std::string_view> words = split_words(text);
  const std::optional<double> seconds = words.size() == 1 ? parse_number(words.front()) : std::nullopt;
  if (seconds && std::isfinite(*seconds)) return *seconds;
  const std::optional<double> date_s =
      words.size() == 2 ? parse_date_s(fmt::format("{} {}", words[0], words[1])) : std::nullopt;
  if (date_s) return *date_s;
  throw InputError(
      fmt::format("{}: '{}' is neither seconds nor a date like 2011-09-26 13:04:32.335", where, text));
}

std::vector<double> read_stamps_s(const std::filesystem::path& file) {
  std::vector<double> stamps_s;
  const std::vector<std::string> lines = read_lines(file);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool blank = is_blank(lines[i]);
    stamps_s.push_back(blank ? std::numeric_limits<double>::quiet_NaN()
                             : parse_stamp_s(lines[i], fmt::format("{}:{}", file.string(), i + 1)));
  }
  return stamps_s;
}

}  // namespace mlo
