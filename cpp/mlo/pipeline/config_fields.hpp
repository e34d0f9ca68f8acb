#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "mlo/core/fields.hpp"

// A configuration struct (core/fields.hpp) seen as a flat list of named values. The templates here only
// collect pointers; printing, reading and checking work on the list (config_io.hpp).
namespace mlo {

/// Where a number is kept, and the values it may take, ends included.
template <class T>
struct NumberSlot {
  T* value;
  T min;
  T max;
};
struct NumberListSlot {
  std::vector<double>* value;
  double min;  ///< of each element
  double max;
};
/// An enumeration: its value as an index into `names`; get() is names.size() for a value without a name.
struct ChoiceSlot {
  std::vector<std::string> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};
using Slot = std::variant<bool*, std::string*, NumberSlot<int>, NumberSlot<std::uint64_t>, NumberSlot<double>,
                          NumberListSlot, ChoiceSlot>;

/// One value of a configuration. Refers to the struct it was collected from.
struct ConfigField {
  std::string path;  ///< dotted, for instance "sensor.max_range_m"
  std::string doc;
  Slot slot;

  /// The value as YAML on one line; text is quoted, numbers are as short as reading them back exactly allows.
  std::string value_text() const;
  /// "0 to 10", "at least 1", "true or false", "one of a, b"; empty where everything is allowed.
  std::string allowed_text() const;
  /// Takes one word (or, for a list, several). Returns what is wrong, without the name of the field, and
  /// leaves the value as it was; nullopt when it was taken.
  std::optional<std::string> assign(const std::vector<std::string>& words, bool is_list) const;
  /// What is wrong with the present value (out of range, not a number); nullopt when nothing is.
  std::optional<std::string> find_problem() const;
};

/// A nested struct of a configuration.
struct ConfigGroup {
  std::string path;
  std::string doc;
};

/// The rules between the values of one struct: its member find_problems().
struct ConfigRule {
  std::string path;  ///< of the struct; empty for the outermost
  std::function<std::vector<std::string>()> find_problems;
};

/// Everything in a configuration, in the order in which the structs list it. Valid as long as the struct is.
struct ConfigView {
  std::vector<ConfigField> fields;
  std::vector<ConfigGroup> groups;
  std::vector<ConfigRule> rules;
};

template <class Config>
concept HasRules = requires(const Config& config) {
  { config.find_problems() } -> std::same_as<std::vector<std::string>>;
};

/// The visitor that collects a ConfigView.
class ConfigCollector {
 public:
  void operator()(std::string_view name, bool& value, Anything, std::string_view doc) {
    add(name, &value, doc);
  }
  void operator()(std::string_view name, std::string& value, Anything, std::string_view doc) {
    add(name, &value, doc);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(std::string_view name, T& value, Anything, std::string_view doc) {
    (*this)(name, value, Bounds<T>{}, doc);
  }
  template <class T, class B>
  requires std::is_arithmetic_v<T>
  void operator()(std::string_view name, T& value, const Bounds<B>& bounds, std::string_view doc) {
    static_assert(std::is_same_v<T, int> || std::is_same_v<T, std::uint64_t> || std::is_same_v<T, double>,
                  "numbers of a configuration are int, std::uint64_t or double");
    const Bounds<T> range = convert<T>(bounds);
    add(name, NumberSlot<T>{&value, range.min, range.max}, doc);
  }
  template <class B>
  void operator()(std::string_view name, std::vector<double>& value, const Bounds<B>& bounds,
                  std::string_view doc) {
    const auto range = convert<double>(bounds);
    add(name, NumberListSlot{&value, range.min, range.max}, doc);
  }
  template <class Enum>
  requires std::is_enum_v<Enum>
  void operator()(std::string_view name, Enum& value, const Choices<Enum>& choices, std::string_view doc) {
    ChoiceSlot slot;
    std::vector<Enum> values;
    for (const auto& [choice_name, choice] : choices) {
      slot.names.emplace_back(choice_name);
      values.push_back(choice);
    }
    slot.get = [&value, values] {
      std::size_t i = 0;
      while (i < values.size() && values[i] != value) ++i;
      return i;
    };
    slot.set = [&value, values](std::size_t i) { value = values.at(i); };
    add(name, std::move(slot), doc);
  }
  template <class Config>
  void group(std::string_view name, Config& config, std::string_view doc) {
    const std::string outer = path_;
    path_ = join(name);
    view_.groups.push_back({path_, std::string(doc)});
    collect(config);
    path_ = outer;
  }
  template <class Config>
  void collect(Config& config) {
    config.fields(*this);
    if constexpr (HasRules<Config>) {
      view_.rules.push_back({path_, [&config] { return config.find_problems(); }});
    }
  }
  ConfigView take() { return std::move(view_); }

 private:
  /// Bounds may be written in another type than the value, as in at_least(1) for a double; an end that is the
  /// limit of its own type means no limit.
  template <class T, class B>
  static Bounds<T> convert(const Bounds<B>& bounds) {
    Bounds<T> range;
    const bool below_type = std::is_unsigned_v<T> && bounds.min < B{0};
    if (bounds.min != std::numeric_limits<B>::lowest() && !below_type) range.min = static_cast<T>(bounds.min);
    if (bounds.max != std::numeric_limits<B>::max()) range.max = static_cast<T>(bounds.max);
    return range;
  }
  std::string join(std::string_view name) const {
    return path_.empty() ? std::string(name) : path_ + "." + std::string(name);
  }
  void add(std::string_view name, Slot slot, std::string_view doc) {
    view_.fields.push_back({join(name), std::string(doc), std::move(slot)});
  }

  std::string path_;
  ConfigView view_;
};

/// All values, groups and rules of a configuration; the view refers to `config` and can change it.
template <class Config>
ConfigView view_config(Config& config) {
  ConfigCollector collector;
  collector.collect(config);
  return collector.take();
}

}  // namespace mlo
