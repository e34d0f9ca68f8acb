#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace mlo {

/// Mixes two numbers into one that looks random (splitmix64's finaliser). A pure function: what is drawn for
/// ray i does not depend on which thread draws it, or in which order.
std::uint64_t mix(std::uint64_t a, std::uint64_t b);

/// A stream of random numbers that is the same on every machine for the same seed (std:: distributions are
/// not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// An independent stream; the same number gives the same stream.
  Random fork(std::uint64_t stream) const { return Random(mix(state_, stream)); }

  std::uint64_t bits();
  /// Uniform in [low, high).
  double uniform(double low = 0.0, double high = 1.0);
  /// Uniform over low, ..., high (both included).
  int integer(int low, int high);
  /// Normal with mean 0 and standard deviation 1 (Box-Muller).
  double normal();
  bool chance(double probability) { return uniform() < probability; }

 private:
  std::uint64_t state_;
};

/// Puts values into an order that depends on how many there are and on the seed alone.
template <class T>
void shuffle(std::vector<T>& values, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.bits() % i]);
}

}  // namespace mlo
