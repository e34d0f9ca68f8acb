#include <algorithm>
#include <numeric>
#include <set>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mlo/network/point_operations.hpp"
#include "network/tiny_network.hpp"

namespace mlo {
namespace {

RowMatrix random_rows(Eigen::Index count, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  RowMatrix rows(count, columns);
  for (float& value : rows.reshaped()) value = normal(random);
  return rows;
}

// The definition, point by point.
std::vector<std::uint32_t> sample_plainly(const RowMatrix& rows, std::size_t count) {
  std::vector<std::uint32_t> chosen{0};
  while (chosen.size() < std::min(count, static_cast<std::size_t>(rows.rows()))) {
    double farthest = -1.0;
    std::uint32_t next = 0;
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      double nearest = 1e30;
      for (const std::uint32_t c : chosen) {
        nearest = std::min(nearest, (rows.row(i) - rows.row(c)).cast<double>().squaredNorm());
      }
      if (nearest > farthest) {
        farthest = nearest;
        next = static_cast<std::uint32_t>(i);
      }
    }
    chosen.push_back(next);
  }
  return chosen;
}

TEST(FarthestPointSampling, EqualsTheDefinition) {
  for (const Eigen::Index columns : {3, 11}) {
    const RowMatrix rows = random_rows(1500, columns, 4);  // more than one block
    EXPECT_EQ(farthest_point_sampling(rows, 40), sample_plainly(rows, 40)) << columns << " columns";
  }
}

TEST(FarthestPointSampling, HandlesFewPointsAndEqualOnes) {
  EXPECT_TRUE(farthest_point_sampling(RowMatrix(0, 3), 5).empty());
  EXPECT_EQ(farthest_point_sampling(RowMatrix::Ones(1, 3), 5), std::vector<std::uint32_t>{0});
  EXPECT_EQ(farthest_point_sampling(RowMatrix::Ones(7, 3), 5), std::vector<std::uint32_t>{0});
  EXPECT_TRUE(farthest_point_sampling(RowMatrix::Ones(7, 3), 0).empty());
  EXPECT_EQ(farthest_point_sampling(random_rows(6, 3, 2), 100).size(), 6U);
}

Groups query_plainly(const PointRows& points, const PointRows& centers, const BallQuery& query) {
  Groups groups;
  for (Eigen::Index i = 0; i < centers.rows(); ++i) {
    std::size_t found = 0;
    for (Eigen::Index k = 0; k < points.rows() && found < query.neighbours; ++k) {
      const float distance = (points.row(k) - centers.row(i)).norm();
      if (distance >= query.radius_m || distance < query.inner_radius_m) continue;
      groups.members.push_back(static_cast<std::uint32_t>(k));
      ++found;
    }
    groups.begins.push_back(static_cast<std::uint32_t>(groups.members.size()));
  }
  return groups;
}

TEST(QueryBalls, EqualsTheDefinition) {
  const PointRows points = test::random_input(2500).points;
  const PointRows centers = test::random_input(200, 8).points;
  for (const BallQuery query :
       {BallQuery{0.0F, 1.5F, 8}, BallQuery{0.7F, 2.5F, 1000}, BallQuery{0.0F, 0.01F, 4}}) {
    const Groups groups = query_balls(points, centers, query);
    const Groups expected = query_plainly(points, centers, query);
    EXPECT_EQ(groups.begins, expected.begins);
    EXPECT_EQ(groups.members, expected.members);
  }
}

TEST(QueryBalls, IsTheSameForAnyNumberOfThreads) {
  const PointRows points = test::random_input(2500).points;
  const BallQuery query{0.0F, 2.0F, 16};
  const Groups many = query_balls(points, points, query);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(query_balls(points, points, query).members, many.members);
}

TEST(QueryBalls, HandlesNothing) {
  const BallQuery query{0.0F, 1.0F, 4};
  EXPECT_EQ(query_balls(PointRows(0, 3), PointRows::Zero(2, 3), query).begins,
            (std::vector<std::uint32_t>{0, 0, 0}));
  EXPECT_EQ(query_balls(PointRows::Zero(2, 3), PointRows(0, 3), query).size(), 0U);
}

}  // namespace
}  // namespace mlo
