#include "mlo/pipeline/config_fields.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace mlo {
namespace {

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <class... Visitors>
Overloaded(Visitors...) -> Overloaded<Visitors...>;

template <class T>
std::string number_text(T value) {
  if constexpr (std::is_same_v<T, double>) {
    if (std::isnan(value)) return ".nan";
    if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
    std::string text = fmt::format("{}", value);
    if (text.find_first_not_of("-0123456789") == std::string::npos) text += ".0";
    return text;
  } else {
    return fmt::format("{}", value);
  }
}

std::string in_quotes(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    } else {
      result += c;
    }
  }
  return result + "\"";
}

template <class T>
std::string range_text(T min, T max) {
  const bool has_min = min != std::numeric_limits<T>::lowest();
  const bool has_max = max != std::numeric_limits<T>::max();
  if (has_min && has_max) return fmt::format("{} to {}", min, max);
  if (has_min) return fmt::format("at least {}", min);
  if (has_max) return fmt::format("at most {}", max);
  return std::is_unsigned_v<T> ? "at least 0" : "";
}

/// NaN is in no range.
template <class T>
std::optional<std::string> range_problem(T value, T min, T max) {
  if (value >= min && value <= max) return std::nullopt;
  const std::string range = range_text(min, max);
  return fmt::format("{} is out of range; allowed: {}", number_text(value),
                     range.empty() ? "finite numbers" : range);
}

template <class T>
std::optional<T> parse(const std::string& word) {
  T value{};
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  if (word.empty() || error != std::errc{} || rest != end) return std::nullopt;
  return value;
}

/// Parses and checks a number; problem is set when the result is not to be used.
template <class T>
T read_number(const std::string& word, T min, T max, std::optional<std::string>& problem) {
  const std::optional<T> value = parse<T>(word);
  if (!value) {
    const char* const kind = std::is_same_v<T, double> ? "a number" : "a whole number";
    const std::string range = range_text(min, max);
    problem = fmt::format("'{}' is not {}{}{}", word, kind, range.empty() ? "" : "; allowed: ", range);
    return T{};
  }
  problem = range_problem(*value, min, max);
  return *value;
}

template <class T>
std::optional<std::string> assign_number(const NumberSlot<T>& slot, const std::string& word) {
  std::optional<std::string> problem;
  const T value = read_number(word, slot.min, slot.max, problem);
  if (!problem) *slot.value = value;
  return problem;
}

std::optional<std::string> assign_list(const NumberListSlot& slot, const std::vector<std::string>& words) {
  std::vector<double> values;
  for (const std::string& word : words) {
    std::optional<std::string> problem;
    values.push_back(read_number(word, slot.min, slot.max, problem));
    if (problem) return fmt::format("element {}: {}", values.size(), *problem);
  }
  *slot.value = std::move(values);
  return std::nullopt;
}

std::optional<std::string> assign_bool(bool* value, const std::string& word) {
  if (word != "true" && word != "false") return fmt::format("'{}' is not true or false", word);
  *value = word == "true";
  return std::nullopt;
}

std::optional<std::string> assign_choice(const ChoiceSlot& slot, const std::string& word) {
  const auto found = std::find(slot.names.begin(), slot.names.end(), word);
  if (found == slot.names.end()) {
    return fmt::format("'{}' is not one of {}", word, fmt::join(slot.names, ", "));
  }
  slot.set(static_cast<std::size_t>(found - slot.names.begin()));
  return std::nullopt;
}

std::optional<std::string> list_problem(const NumberListSlot& slot) {
  for (std::size_t i = 0; i < slot.value->size(); ++i) {
    if (const auto problem = range_problem((*slot.value)[i], slot.min, slot.max)) {
      return fmt::format("element {}: {}", i + 1, *problem);
    }
  }
  return std::nullopt;
}

}  // namespace

std::string ConfigField::value_text() const {
  return std::visit(Overloaded{
                        [](bool* value) { return std::string(*value ? "true" : "false"); },
                        [](std::string* value) { return in_quotes(*value); },
                        [](const NumberListSlot& list) {
                          std::vector<std::string> words;
                          for (const double value : *list.value) words.push_back(number_text(value));
                          return fmt::format("[{}]", fmt::join(words, ", "));
                        },
                        [](const ChoiceSlot& choice) {
                          const std::size_t i = choice.get();
                          return i < choice.names.size() ? choice.names[i] : std::string("\"\"");
                        },
                        [](const auto& number) { return number_text(*number.value); },
                    },
                    slot);
}

std::string ConfigField::allowed_text() const {
  return std::visit(
      Overloaded{
          [](bool*) { return std::string("true or false"); },
          [](std::string*) { return std::string(); },
          [](const ChoiceSlot& choice) { return fmt::format("one of {}", fmt::join(choice.names, ", ")); },
          [](const auto& number) { return range_text(number.min, number.max); },
      },
      slot);
}

std::optional<std::string> ConfigField::assign(const std::vector<std::string>& words, bool is_list) const {
  if (const auto* list = std::get_if<NumberListSlot>(&slot)) {
    if (!is_list) return "needs a list, as in [1.0, 2.0]";
    return assign_list(*list, words);
  }
  if (is_list || words.size() != 1) return "needs one value, not a list";
  const std::string& word = words.front();
  return std::visit(Overloaded{
                        [&](bool* value) { return assign_bool(value, word); },
                        [&](std::string* value) -> std::optional<std::string> {
                          *value = word;
                          return std::nullopt;
                        },
                        [&](const NumberListSlot& list) { return assign_list(list, words); },
                        [&](const ChoiceSlot& choice) { return assign_choice(choice, word); },
                        [&](const auto& number) { return assign_number(number, word); },
                    },
                    slot);
}

std::optional<std::string> ConfigField::find_problem() const {
  return std::visit(
      Overloaded{
          [](bool*) { return std::optional<std::string>(); },
          [](std::string*) { return std::optional<std::string>(); },
          [](const NumberListSlot& list) { return list_problem(list); },
          [](const ChoiceSlot& choice) {
            if (choice.get() < choice.names.size()) return std::optional<std::string>();
            return std::optional<std::string>(
                fmt::format("has no name; allowed: one of {}", fmt::join(choice.names, ", ")));
          },
          [](const auto& number) { return range_problem(*number.value, number.min, number.max); },
      },
      slot);
}

}  // namespace mlo
