#pragma once

#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace mlo {

// How a configuration struct describes itself, once, for printing, reading and checking:
//
//   struct GroundConfig {
//     double seed_height_m = 0.4;
//     template <class Visitor>
//     void fields(Visitor& visit) {
//       visit("seed_height_m", seed_height_m, between(0.0, 5.0), "what it is and what it trades [m]");
//     }
//   };
//
// Nested structs: visit.group("ground", ground, "what it configures"). Enumerations:
// visit("estimator", estimator, Choices<Estimator>{{"two_step", Estimator::two_step}, ...}, "...").
// Rules between values: an optional member `std::vector<std::string> find_problems() const`, one sentence
// each. The visitor is in pipeline/config_fields.hpp; stages need no more than this header.

/// Allowed values of a number, ends included.
template <class T>
struct Bounds {
  T min = std::numeric_limits<T>::lowest();
  T max = std::numeric_limits<T>::max();
};

template <class T>
constexpr Bounds<T> between(T min, T max) {
  return {min, max};
}
template <class T>
constexpr Bounds<T> at_least(T min) {
  return {min, std::numeric_limits<T>::max()};
}

/// For values that need no check (bool, text).
struct Anything {};

/// Names of the values of an enumeration.
template <class Enum>
using Choices = std::vector<std::pair<std::string_view, Enum>>;

}  // namespace mlo
