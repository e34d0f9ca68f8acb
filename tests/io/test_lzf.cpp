#include <random>
#include <string>

#include <gtest/gtest.h>

#include "mlo/io/lzf.hpp"

namespace mlo {
namespace {

using namespace std::string_literals;

/// What liblzf 3.6 makes of kText: literals, a short match and an overlapping long one.
const std::string kText =
    "the scan, the scan, the scan and the map; "
    "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa end";
const std::string kByLiblzf = "\x0athe scan, t\xe0\x08\x09\x03 and\x60\x16\x05map; a\xe0\x28\x00\x03 end"s;

std::string random_bytes(std::size_t size, int alphabet, unsigned seed) {
  std::mt19937 rng(seed);
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(rng() % static_cast<unsigned>(alphabet));
  return bytes;
}

TEST(Lzf, ReadsWhatLiblzfWrote) {
  EXPECT_EQ(lzf_decompress(kByLiblzf, kText.size()), kText);
}

TEST(Lzf, RoundTrips) {
  for (const int alphabet : {1, 2, 4, 256}) {
    for (const std::size_t size : {0U, 1U, 2U, 3U, 4U, 31U, 32U, 33U, 263U, 264U, 265U, 9000U, 100000U}) {
      const std::string bytes = random_bytes(size, alphabet, static_cast<unsigned>(size) + 1U);
      const std::string compressed = lzf_compress(bytes);
      EXPECT_LE(compressed.size(), size + size / 32 + 1);
      EXPECT_EQ(lzf_decompress(compressed, size), bytes) << size << " of " << alphabet;
    }
  }
}

TEST(Lzf, CompressesRepetitions) {
  EXPECT_LT(lzf_compress(std::string(100000, 'a')).size(), 1500U);
  EXPECT_LE(lzf_compress(kText).size(), kByLiblzf.size() + 2);
}

TEST(Lzf, RefusesTheWrongSize) {
  EXPECT_FALSE(lzf_decompress(kByLiblzf, kText.size() - 1).has_value());
  EXPECT_FALSE(lzf_decompress(kByLiblzf, kText.size() + 1).has_value());
  EXPECT_FALSE(lzf_decompress("", 1).has_value());
}

TEST(Lzf, RefusesEveryTruncation) {
  for (std::size_t size = 0; size < kByLiblzf.size(); ++size) {
    EXPECT_FALSE(lzf_decompress(kByLiblzf.substr(0, size), kText.size()).has_value()) << size;
  }
}

TEST(Lzf, RefusesAMatchBeforeTheBeginning) {
  EXPECT_FALSE(lzf_decompress("\x00"
                              "a\x20\x01"s,
                              4)
                   .has_value());
  EXPECT_EQ(lzf_decompress("\x00"
                           "a\x20\x00"s,
                           4),
            "aaaa");
}

TEST(Lzf, SurvivesDamage) {
  std::mt19937 rng(5);
  for (int i = 0; i < 2000; ++i) {
    std::string damaged = kByLiblzf;
    damaged[rng() % damaged.size()] = static_cast<char>(rng());
    const auto result = lzf_decompress(damaged, kText.size());
    EXPECT_TRUE(!result || result->size() == kText.size());
  }
}

}  // namespace
}  // namespace mlo
