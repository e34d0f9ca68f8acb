#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "mlo/core/point_budget.hpp"
#include "mlo/core/random.hpp"

namespace mlo {
namespace {

/// As dense as a lidar's: as many points in each ring of distance.
std::vector<Point> made_scan(std::size_t count) {
  Random random(4);
  std::vector<Point> points(count);
  for (Point& point : points) {
    const double azimuth = random.uniform(-3.14, 3.14);
    const double range = random.uniform(2.0, 80.0);
    point.p_lidar =
        Eigen::Vector3d(range * std::cos(azimuth), range * std::sin(azimuth), random.uniform(-1.7, 1.0))
            .cast<float>();
  }
  return points;
}

std::size_t count_between(const std::vector<Point>& points, float from_m, float to_m) {
  return static_cast<std::size_t>(std::ranges::count_if(points, [&](const Point& point) {
    const float range = point.p_lidar.norm();
    return range >= from_m && range < to_m;
  }));
}

TEST(PointBudget, GivesExactlyAsManyAsAskedInOrder) {
  const std::vector<Point> points = made_scan(20000);
  for (const std::size_t budget : {0U, 1U, 3U, 9U, 100U, 1000U, 4096U, 16384U, 19999U}) {
    const auto kept = points_within_budget(points, budget);
    EXPECT_EQ(kept.size(), budget);
    EXPECT_TRUE(std::ranges::is_sorted(kept));
    EXPECT_EQ(std::set<std::size_t>(kept.begin(), kept.end()).size(), budget);
  }
}

TEST(PointBudget, KeepsAllWhereThereAreFewEnough) {
  const std::vector<Point> points = made_scan(50);
  EXPECT_EQ(points_within_budget(points, 50).size(), 50U);
  EXPECT_EQ(points_within_budget(points, 1000).size(), 50U);
  EXPECT_TRUE(points_within_budget({}, 10).empty());
}

TEST(PointBudget, NeverKeepsWhatIsNotFinite) {
  std::vector<Point> points = made_scan(1000);
  for (std::size_t i = 0; i < points.size(); i += 10) {
    points[i].p_lidar.y() = std::numeric_limits<float>::quiet_NaN();
    points[i + 1].p_lidar.x() = std::numeric_limits<float>::infinity();
  }
  for (const std::size_t budget : {100U, 799U, 800U, 900U}) {
    const auto kept = points_within_budget(points, budget);
    EXPECT_EQ(kept.size(), std::min<std::size_t>(budget, 800U));
    for (const std::size_t i : kept) EXPECT_TRUE(points[i].p_lidar.allFinite());
  }
}

TEST(PointBudget, TakesFromTheNearAndDense) {
  const std::vector<Point> points = made_scan(60000);
  const std::vector<Point> kept = thin_points(points, 16384);
  const auto share = [&](float from_m, float to_m) {
    return static_cast<double>(count_between(kept, from_m, to_m)) /
           static_cast<double>(count_between(points, from_m, to_m));
  };
  const double near = share(0.0F, 10.0F);
  const double middle = share(20.0F, 40.0F);
  const double far = share(60.0F, 80.0F);
  EXPECT_LT(near, 0.5 * middle);
  EXPECT_LT(middle, far);
}

TEST(PointBudget, KeepsEverythingThatStandsAlone) {
  std::vector<Point> points;
  for (int i = 0; i < 5000; ++i) {  // a wall close by
    points.emplace_back().p_lidar = {5.0F, 0.001F * static_cast<float>(i), 0.0F};
  }
  for (int i = 0; i < 100; ++i) points.emplace_back().p_lidar = {60.0F, static_cast<float>(i), 0.0F};
  const std::vector<Point> kept = thin_points(points, 500, 3);
  EXPECT_EQ(kept.size(), 500U);
  EXPECT_EQ(count_between(kept, 50.0F, 200.0F), 100U);
}

TEST(PointBudget, SameSeedSamePointsAnotherSeedOthers) {
  const std::vector<Point> points = made_scan(20000);
  EXPECT_EQ(points_within_budget(points, 4096), points_within_budget(points, 4096));
  EXPECT_EQ(points_within_budget(points, 4096, 7), points_within_budget(points, 4096, 7));
  EXPECT_NE(points_within_budget(points, 4096, 7), points_within_budget(points, 4096, 8));
  EXPECT_NE(points_within_budget(points, 4096, 7), points_within_budget(points, 4096));
}

TEST(PointBudget, EqualPointsAndFarAwayOnes) {
  std::vector<Point> points(100);  // all at the origin
  EXPECT_EQ(points_within_budget(points, 10).size(), 10U);
  for (Point& point : points) point.p_lidar = {1e30F, -1e30F, 3e38F};
  EXPECT_EQ(points_within_budget(points, 10).size(), 10U);
}

}  // namespace
}  // namespace mlo
