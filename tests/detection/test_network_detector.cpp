#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "detection/made_scan.hpp"
#include "mlo/detection/network_detector.hpp"
#include "mlo/detection/network_input.hpp"
#include "network/tiny_network.hpp"

namespace mlo {
namespace {

using ::testing::HasSubstr;

NetworkArchitecture architecture_for(int max_points) {
  NetworkArchitecture architecture = test::tiny_architecture();
  architecture.input.max_points = max_points;
  architecture.input.max_range_m = 30.0;
  return architecture;
}

std::vector<Point> points_of(const test::MadeScan& scan, const NetworkInputSpec& spec) {
  return network_points(scan.points, scan.is_ground, NetworkFrame(scan.points, scan.is_ground, spec), spec);
}

NetworkConfig everything() {
  NetworkConfig config;
  config.min_candidate = 0.0;
  return config;
}

TEST(NetworkInput, HoldsWhatTheNetworkKnows) {
  test::MadeScan scan = test::street_with(test::kParkedCars);
  const NetworkInputSpec spec = architecture_for(500).input;
  const std::vector<Point> points = points_of(scan, spec);
  ASSERT_EQ(points.size(), 500U);
  for (const Point& point : points) {
    EXPECT_LT(point.p_lidar.head<2>().norm(), 30.0F);
    EXPECT_GT(point.p_lidar.z(), 0.0F);  // above the ground, none of which is left
    EXPECT_LE(point.p_lidar.z(), 3.5F);
  }
  const NetworkInput input = network_input(points, spec);
  EXPECT_EQ(input.points.rows(), 500);
  EXPECT_EQ(input.features.col(0), input.points.col(2));
}

TEST(NetworkInput, KeepsGroundAndAnglesAsAsked) {
  const test::MadeScan scan = test::street_with(test::kParkedCars);
  NetworkInputSpec spec = architecture_for(100000).input;
  spec.keeps_ground = true;
  spec.half_angle_deg = 45.0;
  spec.sensor_height_m = 1.73;
  spec.min_height_m = -1.0;
  std::size_t ground = 0;
  for (const Point& point : points_of(scan, spec)) {
    EXPECT_LE(std::abs(std::atan2(point.p_lidar.y(), point.p_lidar.x())), 0.7854F);
    ground += std::abs(point.p_lidar.z() + 1.73F) < 0.05F ? 1 : 0;
  }
  EXPECT_GT(ground, 1000U);
}

// Judged by what the network takes in: which points it samples depends on the last bits of their places.
TEST(NetworkInput, IsTheSameWhereverTheLidarIsMounted) {
  const NetworkInputSpec spec = architecture_for(100000).input;
  test::MadeScan scan = test::street_with(test::kParkedCars);
  const std::vector<Point> low = points_of(scan, spec);
  const double shift_low_m = NetworkFrame(scan.points, scan.is_ground, spec).shift_at(10.0, 2.0);
  for (Point& point : scan.points) point.p_lidar.z() -= 0.5F;
  const std::vector<Point> high = points_of(scan, spec);
  const double shift_high_m = NetworkFrame(scan.points, scan.is_ground, spec).shift_at(10.0, 2.0);
  EXPECT_NEAR(shift_high_m, shift_low_m + 0.5, 1e-4);
  ASSERT_GT(low.size(), 1000U);
  ASSERT_EQ(low.size(), high.size());
  for (std::size_t i = 0; i < low.size(); ++i) {
    ASSERT_LT((low[i].p_lidar - high[i].p_lidar).norm(), 1e-4F);
  }
}

TEST(NetworkDetector, FindsNothingWithoutGroundOrPoints) {
  const Network network(test::random_weights(architecture_for(500)));
  const NetworkConfig config = everything();
  test::MadeScan scan = test::street_with(test::kParkedCars);
  EXPECT_TRUE(detect_with_network({}, {}, network, config).empty());
  std::ranges::fill(scan.is_ground, 0);
  EXPECT_TRUE(detect_with_network(scan.points, scan.is_ground, network, config).empty());
  std::ranges::fill(scan.is_ground, 1);  // and nothing on it
  EXPECT_TRUE(detect_with_network(scan.points, scan.is_ground, network, config).empty());
}

TEST(FindMismatches, NamesWhatIsOtherThanInTraining) {
  NetworkArchitecture architecture = architecture_for(500);
  architecture.input.features = {PointFeature::intensity};
  architecture.input.rings = 64;
  std::vector<Point> points(640);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].ring = static_cast<std::uint16_t>(i % 64);
    points[i].intensity = 0.01F * static_cast<float>(i % 100);
  }
  const Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
  EXPECT_TRUE(find_mismatches(points, up, architecture).empty());
  EXPECT_THAT(find_mismatches(points, Eigen::Vector3f(0.3F, 0.0F, std::sqrt(0.91F)), architecture),
              ::testing::ElementsAre(HasSubstr("tilted by 17 degrees")));
  for (Point& point : points) point.intensity *= 255.0F;
  EXPECT_THAT(find_mismatches(points, up, architecture), ::testing::ElementsAre(HasSubstr("intensities")));
  for (Point& point : points) point.intensity = 0.0F;
  for (Point& point : points) point.ring %= 16;
  EXPECT_THAT(find_mismatches(points, up, architecture),
              ::testing::ElementsAre(HasSubstr("64 rings, this one has 16"), HasSubstr("intensities")));
  EXPECT_TRUE(find_mismatches({}, up, architecture).empty());
}

}  // namespace
}  // namespace mlo
