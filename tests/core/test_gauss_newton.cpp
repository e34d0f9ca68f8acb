#include <random>

#include <gtest/gtest.h>

#include "mlo/core/gauss_newton.hpp"
#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

using Vector6d = NormalEquations::Vector6d;

NormalEquations random_problem(const Vector6d& solution, int directions) {
  std::mt19937 rng(3);
  std::normal_distribution<double> normal;
  NormalEquations sums;
  for (int i = 0; i < 200; ++i) {
    Vector6d J = Vector6d::Zero();
    for (int k = 0; k < directions; ++k) J(k) = normal(rng);
    sums.add(-J.dot(solution), J, 0.5 + 0.1 * (i % 3));
  }
  return sums;
}

TEST(GaussNewton, FindsTheSolutionOfALinearProblem) {
  Vector6d solution;
  solution << 1.0, -2.0, 0.5, 0.01, 0.02, -0.03;
  const GaussNewtonStep step = solve(random_problem(solution, 6), 1e-6, 10.0);
  EXPECT_EQ(step.degenerate_directions, 0);
  EXPECT_LT((step.xi - solution).norm(), 1e-10);
}

TEST(GaussNewton, LeavesUnobservedDirectionsAlone) {
  Vector6d solution;
  solution << 1.0, -2.0, 0.5, 0.01, 0.02, -0.03;
  const GaussNewtonStep step = solve(random_problem(solution, 4), 1e-6, 10.0);
  EXPECT_EQ(step.degenerate_directions, 2);
  EXPECT_LT((step.xi.head<4>() - solution.head<4>()).norm(), 1e-10);
  EXPECT_EQ(step.xi.tail<2>().norm(), 0.0);
}

TEST(GaussNewton, MovesOnlyActiveParameters) {
  Eigen::Matrix<bool, 6, 1> active;
  active << false, false, true, true, true, false;
  Vector6d solution = Vector6d::Ones();
  const GaussNewtonStep step = solve(random_problem(solution, 6), 1e-6, 1.0, active);
  EXPECT_EQ(step.degenerate_directions, 0);
  EXPECT_EQ(step.xi(0), 0.0);
  EXPECT_EQ(step.xi(5), 0.0);
  EXPECT_NE(step.xi(2), 0.0);
}

TEST(GaussNewton, NothingToSolveIsDegenerateNotACrash) {
  const GaussNewtonStep step = solve(NormalEquations{}, 1e-6, 1.0);
  EXPECT_EQ(step.degenerate_directions, 6);
  EXPECT_EQ(step.xi.norm(), 0.0);
}

TEST(ParallelSum, DoesNotDependOnBlocksOrThreads) {
  struct Sum {
    double value = 0.0;
    Sum& operator+=(const Sum& other) {
      value += other.value;
      return *this;
    }
  };
  const auto add = [](Sum& sum, std::size_t i) { sum.value += 1.0 / (1.0 + static_cast<double>(i)); };
  const double first = parallel_sum<Sum>(100001, add).value;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(parallel_sum<Sum>(100001, add).value, first);
  EXPECT_EQ(parallel_sum<Sum>(0, add).value, 0.0);
}

}  // namespace
}  // namespace mlo
