#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "mlo/pipeline/prepare.hpp"

namespace mlo {
namespace {

Point at(double azimuth_deg, double range_m) {
  const double azimuth = azimuth_deg * std::numbers::pi / 180.0;
  Point point;
  point.p_lidar =
      Eigen::Vector3d(range_m * std::cos(azimuth), range_m * std::sin(azimuth), 0.0).cast<float>();
  point.ring = 7;
  point.sweep_fraction = 0.25F;
  return point;
}

Scan scan_of(std::vector<Point> points) {
  return {.points = std::move(points),
          .frame = 12,
          .stamp_s = 3.5,
          .stamp_fraction = 0.2,
          .duration_s = 0.05,
          .motion_compensated = true};
}

TEST(Prepare, KeepsWhatLiesBetweenTheRangeLimits) {
  SensorConfig sensor;
  sensor.min_range_m = 2.0;
  sensor.max_range_m = 50.0;
  const Scan prepared = prepare(scan_of({at(0, 1.9), at(90, 2.1), at(180, 49.9), at(-90, 50.1)}), sensor, {});
  ASSERT_EQ(prepared.points.size(), 2U);
  EXPECT_EQ(prepared.points[0].p_lidar, at(90, 2.1).p_lidar);
  EXPECT_EQ(prepared.points[1].p_lidar, at(180, 49.9).p_lidar);
}

TEST(Prepare, PassesOnEverythingElse) {
  const Scan prepared = prepare(scan_of({at(0, 10)}), {}, {});
  EXPECT_EQ(prepared.frame, 12U);
  EXPECT_EQ(prepared.stamp_s, 3.5);
  EXPECT_EQ(prepared.stamp_fraction, 0.2);
  EXPECT_EQ(prepared.duration_s, 0.05);
  EXPECT_TRUE(prepared.motion_compensated);
  EXPECT_EQ(prepared.points.at(0).ring, 7);
  EXPECT_EQ(prepared.points.at(0).sweep_fraction, 0.25F);
}

TEST(Prepare, TheCamerasViewIsAHalfAngleToBothSides) {
  const InputConfig input{.roi = RegionOfInterest::camera, .camera_half_angle_deg = 45.0};
  for (const double azimuth : {0.0, 44.9, -44.9}) {
    EXPECT_EQ(prepare(scan_of({at(azimuth, 10)}), {}, input).points.size(), 1U) << azimuth;
  }
  for (const double azimuth : {45.1, -45.1, 90.0, 180.0}) {
    EXPECT_EQ(prepare(scan_of({at(azimuth, 10)}), {}, input).points.size(), 0U) << azimuth;
  }
  const InputConfig wide{.roi = RegionOfInterest::camera, .camera_half_angle_deg = 135.0};
  EXPECT_EQ(prepare(scan_of({at(134.9, 10), at(135.1, 10)}), {}, wide).points.size(), 1U);
}

TEST(Prepare, DropsPointsThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (int axis = 0; axis < 3; ++axis) {
      Point point = at(0, 10);
      point.p_lidar(axis) = bad;
      EXPECT_TRUE(prepare(scan_of({point}), {}, {}).points.empty()) << axis << " " << bad;
    }
  }
}

TEST(Prepare, RaisesPointsByTheVerticalCorrection) {
  SensorConfig sensor;
  sensor.vertical_correction_deg = 1.0;
  const Scan prepared = prepare(scan_of({at(30, 10)}), sensor, {});
  EXPECT_NEAR(prepared.points.at(0).p_lidar.z(), 10.0 * std::sin(std::numbers::pi / 180.0), 1e-5);
}

TEST(Prepare, AnEmptyScanStaysEmpty) {
  EXPECT_TRUE(prepare(scan_of({}), {}, {}).points.empty());
}

}  // namespace
}  // namespace mlo
