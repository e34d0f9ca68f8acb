#include <random>

#include <gmock/gmock.h>

#include "mlo/odometry/reference_scan.hpp"

namespace mlo {
namespace {

std::vector<FeaturePoint> random_points(std::size_t count) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> uniform(-20.0F, 20.0F);
  std::vector<FeaturePoint> points(count);
  for (FeaturePoint& point : points) {
    point.p_lidar = {uniform(random), uniform(random), 0.1F * uniform(random)};
    point.ring = static_cast<std::uint16_t>(random() % 8);
  }
  return points;
}

// The nearest distance to those points that accept() takes; max_distance_m where there is none.
template <class Accept>
double nearest_distance(const std::vector<FeaturePoint>& points, const Eigen::Vector3d& p,
                        double max_distance_m, const Accept& accept) {
  double best = max_distance_m;
  for (const FeaturePoint& point : points) {
    if (accept(point)) best = std::min(best, (point.p_lidar.cast<double>() - p).norm());
  }
  return best;
}

TEST(CandidateSet, FindsTheNearestAsBruteForceDoes) {
  const std::vector<FeaturePoint> points = random_points(500);
  const CandidateSet set(points, SweepMotion::none(), 1000);
  ASSERT_EQ(set.size(), points.size());
  for (const FeaturePoint& query : random_points(800)) {
    const Eigen::Vector3d p = query.p_lidar.cast<double>() + Eigen::Vector3d(0.5, -0.3, 0.1);
    constexpr double kReach = 2.0;
    const double expected = nearest_distance(points, p, kReach, [](const FeaturePoint&) { return true; });
    const std::optional<std::size_t> found = set.nearest(p, kReach);
    EXPECT_NEAR(found ? (set.point(*found) - p).norm() : kReach, expected, 1e-4);
    const std::vector<std::size_t> few = set.nearest(p, 5, kReach);
    EXPECT_EQ(few.empty(), !found);
    if (found) {
      EXPECT_EQ(few.front(), *found);
    }
    EXPECT_TRUE(std::is_sorted(few.begin(), few.end(), [&](std::size_t a, std::size_t b) {
      return (set.point(a) - p).norm() < (set.point(b) - p).norm();
    }));
  }
}

TEST(CandidateSet, FindsTheNearestOnARingAsBruteForceDoes) {
  const std::vector<FeaturePoint> points = random_points(500);
  const CandidateSet set(points, SweepMotion::none(), 1000);
  for (const FeaturePoint& query : random_points(800)) {
    const Eigen::Vector3d p = query.p_lidar.cast<double>() + Eigen::Vector3d(0.5, -0.3, 0.1);
    constexpr double kReach = 6.0;
    const double expected = nearest_distance(points, p, kReach, [&](const FeaturePoint& point) {
      return point.ring == query.ring && point.p_lidar.x() > 0.0F;
    });
    const auto found = set.nearest_on_ring(RingQuery(p), query.ring, kReach,
                                           [](const Eigen::Vector3f& q) { return q.x() > 0.0F; });
    EXPECT_NEAR(found ? (set.point(*found) - p).norm() : kReach, expected, 1e-4);
    if (found) {
      EXPECT_EQ(set.ring(*found), query.ring);
    }
  }
  EXPECT_FALSE(
      set.nearest_on_ring(RingQuery({1, 1, 0}), 99, 6.0, [](const Eigen::Vector3f&) { return true; }));
}

TEST(CandidateSet, StaysValidWhenMoved) {
  CandidateSet set(random_points(100), SweepMotion::none(), 1000);
  const Eigen::Vector3d p = set.point(42);
  const CandidateSet moved = std::move(set);
  EXPECT_EQ(moved.nearest(p, 0.1), std::optional<std::size_t>(42));
}

TEST(CandidateSet, ThinsEvenlyAndLeavesOutWhatIsNotFinite) {
  std::vector<FeaturePoint> points = random_points(1000);
  EXPECT_EQ(CandidateSet(points, SweepMotion::none(), 100).size(), 100U);
  points[5].p_lidar.x() = NAN;
  EXPECT_EQ(CandidateSet(points, SweepMotion::none(), 1000).size(), 999U);
}

TEST(CandidateSet, HandlesNothing) {
  const CandidateSet set({}, SweepMotion::none(), 100);
  EXPECT_EQ(set.size(), 0U);
  EXPECT_FALSE(set.nearest({0, 0, 0}, 1.0));
  EXPECT_TRUE(set.nearest({0, 0, 0}, 3, 1.0).empty());
  EXPECT_FALSE(CandidateSet().nearest({0, 0, 0}, 1.0));
  EXPECT_FALSE(
      CandidateSet(random_points(10), SweepMotion::none(), 100).nearest(Eigen::Vector3d::Constant(NAN), 1.0));
}

TEST(ReferenceScan, RemovesDistortion) {
  Percept percept;
  percept.edge.candidates = random_points(50);
  for (FeaturePoint& point : percept.edge.candidates) point.sweep_fraction = 0.25F;
  const SweepMotion motion(SE3(Eigen::Quaterniond::Identity(), {2.0, 0.0, 0.0}), 0.5);
  const ReferenceScan reference = make_reference_scan(percept, motion, 100);
  EXPECT_EQ(reference.ground.size(), 0U);
  // Measured a quarter of the sweep before the reference time: half a metre behind where it is reached then.
  const Eigen::Vector3d p =
      percept.edge.candidates[0].p_lidar.cast<double>() - Eigen::Vector3d(0.5, 0.0, 0.0);
  EXPECT_TRUE(reference.edge.nearest(p, 1e-3));
}

}  // namespace
}  // namespace mlo
