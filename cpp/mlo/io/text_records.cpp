#include "mlo/io/text_records.hpp"

#include <charconv>
#include <chrono>
#include <fstream>
#include <limits>

#include <fmt/format.h>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

constexpr std::string_view kBlanks = " \t\r,";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

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

// "yyyy-mm-dd hh:mm:ss.fraction"; NaN if it is not that.
double parse_date_s(std::string_view text) {
  int year = 0;
  unsigned month = 0;
  unsigned day = 0;
  int hour = 0;
  int minute = 0;
  double second = 0.0;
  const bool well_formed = take(text, year) && take(text, '-') && take(text, month) && take(text, '-') &&
                           take(text, day) && (take(text, ' ') || take(text, 'T')) && take(text, hour) &&
                           take(text, ':') && take(text, minute) && take(text, ':') && take(text, second) &&
                           text.empty();
  const std::chrono::year_month_day date{std::chrono::year{year}, std::chrono::month{month},
                                         std::chrono::day{day}};
  if (!well_formed || !date.ok()) return std::numeric_limits<double>::quiet_NaN();
  const auto days = std::chrono::sys_days{date}.time_since_epoch().count();
  return static_cast<double>(days) * 86400.0 + hour * 3600 + minute * 60 + second;
}

}  // namespace

std::vector<std::string> read_lines(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError(fmt::format("{}: cannot be opened; check that it exists", file.string()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(line);
  }
  while (!lines.empty() && trimmed(lines.back()).empty()) lines.pop_back();
  return lines;
}

std::vector<double> parse_numbers(std::string_view line, std::string_view where) {
  std::vector<double> numbers;
  for (std::string_view rest = trimmed(line); !rest.empty(); rest = trimmed(rest)) {
    double value = 0.0;
    const std::string_view before = rest;
    const bool is_number = take(rest, value);
    if (!is_number || (!rest.empty() && kBlanks.find(rest.front()) == std::string_view::npos)) {
      throw InputError(
          fmt::format("{}: '{}' is not a number", where, before.substr(0, before.find_first_of(kBlanks))));
    }
    numbers.push_back(value);
  }
  return numbers;
}

double parse_stamp_s(std::string_view text, std::string_view where) {
  const std::string_view stamp = trimmed(text);
  std::string_view rest = stamp;
  double seconds = 0.0;
  if (take(rest, seconds) && rest.empty()) return seconds;
  const double date_s = parse_date_s(stamp);
  if (date_s != date_s) {
    throw InputError(
        fmt::format("{}: '{}' is neither seconds nor a date like 2011-09-26 13:04:32.335", where, stamp));
  }
  return date_s;
}

std::vector<double> read_stamps_s(const std::filesystem::path& file) {
  std::vector<double> stamps_s;
  const std::vector<std::string> lines = read_lines(file);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool blank = trimmed(lines[i]).empty();
    stamps_s.push_back(blank ? std::numeric_limits<double>::quiet_NaN()
                             : parse_stamp_s(lines[i], fmt::format("{}:{}", file.string(), i + 1)));
  }
  return stamps_s;
}

}  // namespace mlo
