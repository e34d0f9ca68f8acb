#include <cmath>
#include <filesystem>
#include <numbers>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/synthetic_sweep.hpp"
#include "mlo/core/azimuth.hpp"
#include "mlo/io/sweep_structure.hpp"
#include "mlo/io/velodyne_bin.hpp"
#include "real_data.hpp"

namespace mlo {
namespace {

using test::make_sweep;
using test::SweepLayout;

SensorConfig even_sensor(int rings) {
  SensorConfig sensor;
  sensor.rings = rings;
  sensor.max_elevation_deg = 10.0;
  sensor.min_elevation_deg = -20.0;
  return sensor;
}

// Recovers the rings of a sweep whose true ones are known and returns the share of points with the right one.
double share_right(std::vector<Point> points, const SensorConfig& sensor, RingRecovery& recovery) {
  std::vector<std::uint16_t> truth;
  for (Point& point : points) {
    truth.push_back(point.ring);
    point.ring = Point::kNoRing;
  }
  recovery = recover_rings(points, sensor);
  std::size_t right = 0;
  for (std::size_t i = 0; i < points.size(); ++i) right += points[i].ring == truth[i];
  return static_cast<double>(right) / static_cast<double>(points.size());
}

Point at_azimuth_deg(double azimuth_deg) {
  const double a = azimuth_deg * std::numbers::pi / 180.0;
  Point point;
  point.p_lidar = Eigen::Vector3d(10.0 * std::cos(a), 10.0 * std::sin(a), 1.0).cast<float>();
  return point;
}

struct Storage {
  int rings;
  double cut_azimuth_deg;
  bool counter_clockwise;
  bool highest_first;
};

class RingRecoveryOf : public testing::TestWithParam<Storage> {};

TEST_P(RingRecoveryOf, FindsEveryRing) {
  const Storage& storage = GetParam();
  const SensorConfig sensor = storage.rings == 64 ? hdl64e() : even_sensor(storage.rings);
  const std::vector<Point> points = make_sweep({.sensor = sensor,
                                                .cut_azimuth_deg = storage.cut_azimuth_deg,
                                                .counter_clockwise = storage.counter_clockwise,
                                                .highest_first = storage.highest_first});
  for (const bool sensor_known : {true, false}) {
    RingRecovery recovery;
    EXPECT_EQ(share_right(points, sensor_known ? sensor : SensorConfig{}, recovery), 1.0);
    EXPECT_TRUE(recovery.recovered) << recovery.problem;
    EXPECT_EQ(recovery.rings, static_cast<std::size_t>(storage.rings));
    EXPECT_TRUE(recovery.monotone_elevations);
    EXPECT_LT(recovery.corrected_share, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Storages, RingRecoveryOf,
                         testing::Values(Storage{64, 0.0, true, true}, Storage{64, 180.0, false, true},
                                         Storage{64, 37.3, true, false}, Storage{32, 0.0, false, true},
                                         Storage{32, 123.4, true, true}, Storage{16, 180.0, true, false},
                                         Storage{16, -90.0, false, true}, Storage{16, 37.3, false, false},
                                         Storage{128, 0.0, true, true}));

TEST(RecoverRings, SurvivesJitterAtTheCut) {
  RingRecovery recovery;
  const SweepLayout layout{.sensor = hdl64e(), .cut_azimuth_deg = 20.0, .azimuth_jitter = 1.3};
  EXPECT_GT(share_right(make_sweep(layout), hdl64e(), recovery), 0.9999);
  EXPECT_EQ(recovery.rings, 64U);
  EXPECT_GT(recovery.corrected_share, 0.0);
}

TEST(RecoverRings, NumbersWhatIsLeftWhenRingsAreAbsent) {
  RingRecovery recovery;
  std::vector<int> absent;
  for (int ring = 52; ring < 64; ++ring) absent.push_back(ring);
  EXPECT_EQ(share_right(make_sweep({.sensor = hdl64e(), .absent_rings = absent}), hdl64e(), recovery), 1.0);
  EXPECT_EQ(recovery.rings, 52U);
  EXPECT_EQ(share_right(make_sweep({.sensor = even_sensor(16), .absent_rings = {3, 5, 6}}), even_sensor(16),
                        recovery),
            1.0);
  EXPECT_EQ(recovery.rings, 13U);
}

TEST(RecoverRings, RejectsTheWrongSensor) {
  std::vector<Point> points = make_sweep({.sensor = hdl64e()});
  const RingRecovery recovery = recover_rings(points, even_sensor(32));
  EXPECT_FALSE(recovery.recovered);
  EXPECT_EQ(recovery.problem, "64 scan lines, but the sensor has 32");
  EXPECT_EQ(points.front().ring, Point::kNoRing);
}

TEST(RecoverRings, RejectsOtherOrders) {
  const std::vector<Point> sweep = make_sweep({.sensor = even_sensor(16)});
  std::vector<Point> shuffled = sweep;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(3));
  std::vector<Point> by_column = sweep;
  std::stable_sort(by_column.begin(), by_column.end(), [](const Point& a, const Point& b) {
    return azimuth_turns(a.p_lidar.x(), a.p_lidar.y()) < azimuth_turns(b.p_lidar.x(), b.p_lidar.y());
  });
  const std::vector<Point> one_line(sweep.begin(), sweep.begin() + 500);
  const std::vector<Point> same_place(1000, sweep.front());
  for (std::vector<Point> points :
       {shuffled, by_column, one_line, same_place, std::vector<Point>{}, {Point{}}}) {
    const RingRecovery recovery = recover_rings(points, even_sensor(16));
    EXPECT_FALSE(recovery.recovered);
    EXPECT_FALSE(recovery.problem.empty());
    for (const Point& point : points) ASSERT_EQ(point.ring, Point::kNoRing);
  }
}

TEST(OrderRings, CountsFromTheHighest) {
  const SensorConfig sensor = even_sensor(16);
  const std::vector<Point> truth = make_sweep({.sensor = sensor, .columns = 40});
  const auto renumbered = [&](auto number_of) {
    std::vector<Point> points = truth;
    for (Point& point : points) point.ring = static_cast<std::uint16_t>(number_of(point.ring));
    EXPECT_TRUE(order_rings(points, sensor));
    return points;
  };
  const auto equal_truth = [&](const std::vector<Point>& points) {
    return std::equal(points.begin(), points.end(), truth.begin(),
                      [](const Point& a, const Point& b) { return a.ring == b.ring; });
  };
  EXPECT_TRUE(equal_truth(renumbered([](int ring) { return ring; })));
  EXPECT_TRUE(equal_truth(renumbered([](int ring) { return 15 - ring; })));
  EXPECT_TRUE(equal_truth(renumbered([](int ring) { return ring % 2 == 0 ? ring / 2 : 8 + ring / 2; })));
}

TEST(OrderRings, AbsentRingsKeepTheirNumbers) {
  std::vector<Point> points = make_sweep({.sensor = even_sensor(16), .columns = 40, .absent_rings = {0, 7}});
  for (Point& point : points) point.ring = static_cast<std::uint16_t>(15 - point.ring);
  ASSERT_TRUE(order_rings(points, even_sensor(16)));
  EXPECT_EQ(points.front().ring, 1);
  EXPECT_EQ(points.back().ring, 15);
}

TEST(OrderRings, OneNumberForAllIsNone) {
  std::vector<Point> points = make_sweep({.sensor = even_sensor(16), .columns = 40});
  for (Point& point : points) point.ring = 0;
  EXPECT_FALSE(order_rings(points, even_sensor(16)));
  EXPECT_EQ(points.front().ring, Point::kNoRing);
  EXPECT_FALSE(order_rings({}, even_sensor(16)));
}

TEST(RecoverSweepFractions, KnownAnswers) {
  SensorConfig kitti = hdl64e();
  std::vector<Point> points{at_azimuth_deg(179.0), at_azimuth_deg(90.0), at_azimuth_deg(0.0),
                            at_azimuth_deg(-90.0), at_azimuth_deg(-179.0)};
  recover_sweep_fractions(points, kitti);
  EXPECT_NEAR(points[0].sweep_fraction, 1.0 / 360.0, 1e-6);
  EXPECT_NEAR(points[1].sweep_fraction, 0.25, 1e-6);
  EXPECT_NEAR(points[2].sweep_fraction, 0.5, 1e-6);
  EXPECT_NEAR(points[3].sweep_fraction, 0.75, 1e-6);
  EXPECT_NEAR(points[4].sweep_fraction, 359.0 / 360.0, 1e-6);
}

TEST(RecoverSweepFractions, AnyStartBothDirections) {
  for (const double start_deg : {-180.0, -37.0, 0.0, 90.0, 213.0, 360.0}) {
    for (const bool clockwise : {true, false}) {
      SensorConfig sensor;
      sensor.start_azimuth_deg = start_deg;
      sensor.clockwise = clockwise;
      std::vector<Point> points;
      for (int i = 0; i < 100; ++i) {
        const double along_deg = 3.6 * (i + 0.5);
        points.push_back(at_azimuth_deg(start_deg + (clockwise ? -along_deg : along_deg)));
      }
      recover_sweep_fractions(points, sensor);
      for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_NEAR(points[i].sweep_fraction, (static_cast<double>(i) + 0.5) / 100.0, 1e-6) << start_deg;
      }
    }
  }
}

TEST(CorrectVerticalAngle, RaisesElevationsAndKeepsRangeAndAzimuth) {
  std::vector<Point> points = make_sweep({.sensor = even_sensor(16), .columns = 50});
  points.push_back(Point{.p_lidar = {0.0F, 0.0F, 3.0F}});
  const std::vector<Point> before = points;
  correct_vertical_angle(points, 0.205);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    // The rotation by +0.205 degrees about p x z, written out.
    const Eigen::Vector3d p = before[i].p_lidar.cast<double>();
    const Eigen::Vector3d axis = p.cross(Eigen::Vector3d::UnitZ()).normalized();
    const Eigen::Vector3d expected = Eigen::AngleAxisd(0.205 * std::numbers::pi / 180.0, axis) * p;
    ASSERT_LT((points[i].p_lidar.cast<double>() - expected).norm(), 1e-5);
    ASSERT_GT(points[i].p_lidar.z(), before[i].p_lidar.z());
  }
  EXPECT_EQ(points.back().p_lidar, before.back().p_lidar);
}

TEST(RealScans, HaveTheRingsAndTimesOfTheirLidar) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const std::vector<std::filesystem::path> folders{
      *data / "kitti_odometry/sequences/01/velodyne", *data / "kitti_odometry/sequences/04/velodyne",
      *data / "kitti_raw/2011_09_26/2011_09_26_drive_0005_sync/velodyne_points/data",
      *data / "kitti_raw/2011_09_26/2011_09_26_drive_0009_sync/velodyne_points/data"};
  for (const auto& folder : folders) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".bin") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (std::size_t i = 0; i + 1 < files.size(); i += 7) {
      std::vector<Point> points = read_velodyne_bin(files[i]).points;
      const RingRecovery recovery = recover_rings(points, hdl64e());
      recover_sweep_fractions(points, hdl64e());
      EXPECT_EQ(recovery.rings, 64U) << files[i];
      EXPECT_TRUE(recovery.monotone_elevations) << files[i];
      EXPECT_LT(recovery.corrected_share, 1e-3) << files[i];
      for (const Point& point : points) {
        ASSERT_LT(point.ring, 64);
        ASSERT_GE(point.sweep_fraction, 0.0F);
        ASSERT_LE(point.sweep_fraction, 1.0F);
      }
    }
  }
}

TEST(RealScans, TheTruncatedLastScanKeepsItsRings) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const auto folder = *data / "kitti_raw/2011_09_26/2011_09_26_drive_0005_sync/velodyne_points/data";
  std::vector<Point> points = read_velodyne_bin(folder / "0000000153.bin").points;
  const RingRecovery recovery = recover_rings(points, hdl64e());
  EXPECT_EQ(recovery.rings, 53U);
  EXPECT_EQ(points.front().ring, 0);
  EXPECT_EQ(points.back().ring, 52);
}

}  // namespace
}  // namespace mlo
