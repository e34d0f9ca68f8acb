#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "mlo/core/random.hpp"

namespace mlo {
namespace {

constexpr int kDraws = 20000;

TEST(Random, SameSeedGivesTheSameNumbersAndAnotherSeedOthers) {
  Random a(7), b(7), c(8);
  for (int i = 0; i < 100; ++i) {
    const std::uint64_t value = a.bits();
    EXPECT_EQ(value, b.bits());
    EXPECT_NE(value, c.bits());
  }
}

TEST(Random, ForksDoNotDependOnWhatWasDrawnFromOtherForks) {
  const Random root(3);
  Random first = root.fork(1);
  for (int i = 0; i < 50; ++i) first.bits();
  EXPECT_EQ(root.fork(2).uniform(), Random(3).fork(2).uniform());
  EXPECT_NE(root.fork(1).uniform(), root.fork(2).uniform());
}

TEST(Random, NormalHasMeanZeroVarianceOneAndNormalTails) {
  Random random(11);
  double sum = 0.0, squares = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.normal();
    sum += value;
    squares += value * value;
    beyond_two += std::abs(value) > 2.0 ? 1 : 0;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 4.0 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 1.0, 4.0 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(static_cast<double>(beyond_two) / kDraws, 0.0455, 0.006);
}

TEST(Random, IntegersCoverBothEndsEvenly) {
  Random random(5);
  std::vector<int> counts(4, 0);
  for (int i = 0; i < kDraws; ++i) ++counts.at(static_cast<std::size_t>(random.integer(2, 5) - 2));
  for (const int count : counts) EXPECT_NEAR(count, kDraws / 4, 300);
}

}  // namespace
}  // namespace mlo
