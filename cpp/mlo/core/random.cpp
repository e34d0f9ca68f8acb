#include "mlo/core/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mlo {
namespace {

constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15ULL;

std::uint64_t finalise(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

}  // namespace

std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
  return finalise(finalise(a + kGolden) ^ (b * kGolden + 1));
}

std::uint64_t Random::bits() {
  state_ += kGolden;
  return finalise(state_);
}

double Random::uniform(double low, double high) {
  const double unit = static_cast<double>(bits() >> 11) * 0x1.0p-53;
  return low + (high - low) * unit;
}

int Random::integer(int low, int high) {
  const int drawn = low + static_cast<int>(uniform() * (high - low + 1));
  return std::min(drawn, high);
}

double Random::normal() {
  const double u = 1.0 - uniform();  // in (0, 1]
  const double v = uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

}  // namespace mlo
