#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "mlo/core/assignment.hpp"

namespace mlo {
namespace {

double cost_of(const Eigen::MatrixXd& cost, const std::vector<Assignment>& pairs) {
  double sum = 0.0;
  for (const auto& [row, col] : pairs) sum += cost(row, col);
  return sum;
}

// Least cost over all ways to give each row of the smaller side a partner of its own.
double brute_force(const Eigen::MatrixXd& cost) {
  if (cost.rows() > cost.cols()) return brute_force(cost.transpose());
  std::vector<Eigen::Index> cols(static_cast<std::size_t>(cost.cols()));
  std::iota(cols.begin(), cols.end(), 0);
  double best = std::numeric_limits<double>::max();
  do {
    double sum = 0.0;
    for (Eigen::Index row = 0; row < cost.rows(); ++row)
      sum += cost(row, cols[static_cast<std::size_t>(row)]);
    best = std::min(best, sum);
  } while (std::next_permutation(cols.begin(), cols.end()));
  return best;
}

void expect_valid(const Eigen::MatrixXd& cost, const std::vector<Assignment>& pairs) {
  ASSERT_EQ(static_cast<Eigen::Index>(pairs.size()), std::min(cost.rows(), cost.cols()));
  std::set<Eigen::Index> cols;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_TRUE(cols.insert(pairs[i].col).second);
    if (i > 0) {
      EXPECT_LT(pairs[i - 1].row, pairs[i].row);
    }
  }
}

TEST(Assignment, EqualsBruteForceForAllShapes) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> uniform(-5.0, 5.0);
  for (Eigen::Index rows = 1; rows <= 6; ++rows) {
    for (Eigen::Index cols = 1; cols <= 6; ++cols) {
      for (int repeat = 0; repeat < 10; ++repeat) {
        const Eigen::MatrixXd cost = Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return uniform(rng); });
        const std::vector<Assignment> pairs = optimal_assignment(cost);
        expect_valid(cost, pairs);
        EXPECT_NEAR(cost_of(cost, pairs), brute_force(cost), 1e-12);
      }
    }
  }
}

TEST(Assignment, TiesAndForbiddenPairs) {
  std::mt19937 rng(12);
  std::uniform_int_distribution<int> few(0, 3);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const Eigen::MatrixXd cost =
        Eigen::MatrixXd::NullaryExpr(5, 6, [&] { return few(rng) == 0 ? 1e6 : few(rng) * 0.25; });
    const std::vector<Assignment> pairs = optimal_assignment(cost);
    expect_valid(cost, pairs);
    EXPECT_DOUBLE_EQ(cost_of(cost, pairs), brute_force(cost));
  }
}

TEST(Assignment, NothingToAssign) {
  EXPECT_TRUE(optimal_assignment(Eigen::MatrixXd(0, 0)).empty());
  EXPECT_TRUE(optimal_assignment(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_TRUE(optimal_assignment(Eigen::MatrixXd(3, 0)).empty());
}

TEST(Assignment, PrefersTheCrossingWhereItIsCheaper) {
  Eigen::MatrixXd cost(2, 2);
  cost << 1.0, 1.1, 1.1, 5.0;
  const std::vector<Assignment> pairs = optimal_assignment(cost);
  EXPECT_EQ(pairs[0].col, 1);
  EXPECT_EQ(pairs[1].col, 0);
}

}  // namespace
}  // namespace mlo
