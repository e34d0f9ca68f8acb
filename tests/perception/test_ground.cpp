#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mlo/perception/ground.hpp"
#include "perception/synthetic_scan.hpp"

namespace mlo {
namespace {

using test::make_scan;
using test::Scene;
using test::street;
using test::SyntheticScan;

struct Agreement {
  double ground_found = 0.0;  ///< share of the ground points that were marked
  double false_ground = 0.0;  ///< share of the other points that were marked, well above or below the ground
};

/// Points on boxes within 0.25 m of the ground may be marked: the method goes by height alone.
Agreement compare(const SyntheticScan& scan, const Scene& scene, const GroundSegmentation& found) {
  Agreement agreement;
  double truly_ground = 0.0;
  for (std::size_t i = 0; i < scan.is_ground.size(); ++i) {
    const Eigen::Vector3f& p = scan.scan.points[i].p_lidar;
    const double height = p.z() - scene.ground_z(p.x(), p.y());
    if (scan.is_ground[i] != 0) {
      truly_ground += 1.0;
      agreement.ground_found += found.is_ground[i];
    } else if (std::abs(height) > 0.25 && found.is_ground[i] != 0) {
      agreement.false_ground += 1.0;
    }
  }
  agreement.ground_found /= truly_ground;
  agreement.false_ground /= static_cast<double>(scan.is_ground.size()) - truly_ground;
  return agreement;
}

class GroundAtHeight : public testing::TestWithParam<double> {};

TEST_P(GroundAtHeight, IsFoundOnAStreet) {
  const Scene scene = street(GetParam());
  const SyntheticScan scan = make_scan(scene);
  const GroundSegmentation found = segment_ground(scan.scan.points, {});
  ASSERT_TRUE(found.found);
  EXPECT_NEAR(found.nearby.offset_m, GetParam(), 0.03);
  EXPECT_GT(found.nearby.normal.z(), std::cos(0.01));
  const Agreement agreement = compare(scan, scene, found);
  EXPECT_GT(agreement.ground_found, 0.999);
  EXPECT_LT(agreement.false_ground, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Heights, GroundAtHeight, testing::Values(0.5, 1.0, 1.73, 2.5));

TEST(Ground, HoldsOnATiltedPlane) {
  const Scene scene{.ground_z = [](double x, double y) { return -1.7 + 0.14 * x - 0.07 * y; }};
  const SyntheticScan scan = make_scan(scene);
  const GroundSegmentation found = segment_ground(scan.scan.points, {});
  EXPECT_GT(compare(scan, scene, found).ground_found, 0.999);
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.14, 0.07, 1.0).normalized();
  EXPECT_GT(found.nearby.normal.cast<double>().dot(normal), std::cos(0.01));
}

TEST(Ground, FollowsASlopeThatBeginsAhead) {
  const Scene scene{.ground_z = [](double x, double) { return -1.7 + 0.1 * std::max(0.0, x - 12.0); },
                    .boxes = {test::standing_box(9.0, 6.0, -1.7, {4.0, 2.0, 1.5})}};
  const SyntheticScan scan = make_scan(scene);
  const Agreement agreement = compare(scan, scene, segment_ground(scan.scan.points, {}));
  EXPECT_GT(agreement.ground_found, 0.98);
  EXPECT_LT(agreement.false_ground, 0.01);
}

TEST(Ground, TakesInPavementsBesideKerbs) {
  const Scene scene{.ground_z = [](double, double y) { return std::abs(y) > 4.0 ? -1.58 : -1.73; }};
  const SyntheticScan scan = make_scan(scene);
  EXPECT_GT(compare(scan, scene, segment_ground(scan.scan.points, {})).ground_found, 0.98);
}

TEST(Ground, IsNotDrawnDownByMultipath) {
  const Scene scene = street(1.73);
  SyntheticScan scan = make_scan(scene);
  std::vector<Point> below;
  for (std::size_t i = 0; i < scan.scan.points.size(); i += 40) {
    const Point& point = scan.scan.points[i];
    if (scan.is_ground[i] == 0 || point.p_lidar.head<2>().norm() > 20.0F) continue;
    below.push_back(point);
    below.back().p_lidar *= 1.5F;  // the beam goes on as if the ground were not there
  }
  ASSERT_GT(below.size(), 400U);
  const std::size_t real_points = scan.scan.points.size();
  scan.scan.points.insert(scan.scan.points.end(), below.begin(), below.end());
  const GroundSegmentation found = segment_ground(scan.scan.points, {});
  EXPECT_NEAR(found.nearby.offset_m, 1.73, 0.03);
  EXPECT_GT(compare(scan, scene, found).ground_found, 0.995);
  for (std::size_t i = real_points; i < scan.scan.points.size(); ++i) {
    ASSERT_EQ(found.is_ground[i], 0) << scan.scan.points[i].p_lidar.transpose();
  }
}

TEST(Ground, ASingleWallIsNone) {
  std::vector<Point> points;
  for (int y = -100; y < 100; ++y) {
    for (int z = 0; z < 60; ++z) {
      Point point;
      point.p_lidar = Eigen::Vector3f(20.0F, 0.05F * static_cast<float>(y), 0.05F * static_cast<float>(z));
      points.push_back(point);
    }
  }
  const GroundSegmentation found = segment_ground(points, {});
  EXPECT_FALSE(found.found);
  EXPECT_EQ(found.is_ground, std::vector<std::uint8_t>(points.size(), 0));
}

TEST(Ground, NothingOnePointAndManyAtOnePlace) {
  EXPECT_FALSE(segment_ground({}, {}).found);
  for (const Eigen::Vector3f& p : {Eigen::Vector3f(0.0F, 0.0F, 0.0F), Eigen::Vector3f(3.0F, 1.0F, -1.7F)}) {
    for (const std::size_t count : {1U, 1000U}) {
      Point point;
      point.p_lidar = p;
      const std::vector<Point> points(count, point);
      EXPECT_EQ(segment_ground(points, {}).is_ground.size(), count);
    }
  }
}

TEST(Ground, EveryConfigurationInItsBoundsHasSectorsAndZonesForAllPoints) {
  const SyntheticScan scan = make_scan(street(1.73), 16, 180);
  for (const int sectors : {4, 180}) {
    for (const double depth : {0.5, 20.0}) {
      for (const double growth : {0.0, 1.0}) {
        const GroundConfig config{.sectors = sectors, .zone_depth_m = depth, .zone_growth = growth};
        EXPECT_TRUE(segment_ground(scan.scan.points, config).found);
      }
    }
  }
}

TEST(Ground, DoesNotDependOnTheNumberOfThreads) {
  const SyntheticScan scan = make_scan(street(1.73));
  std::vector<std::vector<std::uint8_t>> results;
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(segment_ground(scan.scan.points, {}).is_ground);
  }
  EXPECT_EQ(results[0], results[1]);
}

}  // namespace
}  // namespace mlo
