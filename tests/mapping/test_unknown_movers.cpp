#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "mlo/core/archive.hpp"
#include "mlo/mapping/unknown_movers.hpp"

namespace mlo {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

// Where a ray from the origin enters a box, as a factor of its direction.
std::optional<double> entry(const AlignedBox3d& box, const Vector3d& direction) {
  double from = 0.0;
  double to = 1e9;
  for (int k = 0; k < 3; ++k) {
    const double a = box.min()(k) / direction(k);
    const double b = box.max()(k) / direction(k);
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from < to ? std::optional(from) : std::nullopt;
}

// A lidar at rest in the origin that sees boxes; before nothing else but the sky.
std::vector<Point> scan_of(const std::vector<AlignedBox3d>& boxes) {
  std::vector<Point> points;
  for (int ring = 0; ring < 40; ++ring) {
    const double elevation = (-15.0 + 0.4 * ring + 0.01) * std::numbers::pi / 180.0;
    for (int step = -360; step < 360; ++step) {
      const double azimuth = (0.2 * step + 0.03) * std::numbers::pi / 180.0;
      const Vector3d ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                         std::sin(elevation));
      double range_m = 1e9;
      for (const AlignedBox3d& box : boxes) range_m = std::min(range_m, entry(box, ray).value_or(1e9));
      if (range_m > 100.0) continue;
      Point point;
      point.p_lidar = (range_m * ray).cast<float>();
      point.ring = static_cast<std::uint16_t>(ring);
      point.sweep_fraction = 0.5F;
      points.push_back(point);
    }
  }
  return points;
}

std::vector<Eigen::Vector3f> places(const std::vector<Point>& scan) {
  std::vector<Eigen::Vector3f> places;
  for (const Point& point : scan) places.push_back(point.p_lidar);
  return places;
}

const AlignedBox3d kWallBehind(Vector3d(40.0, -60.0, -20.0), Vector3d(41.0, 60.0, 3.0));
const AlignedBox3d kPost(Vector3d(12.0, 5.0, -5.0), Vector3d(12.6, 5.6, 2.0));

// Comes from the right at 10 m/s.
AlignedBox3d passing(double length_m, double front_m) {
  return {Vector3d(20.0, front_m - length_m, -4.0), Vector3d(22.0, front_m, -1.0)};
}

UnknownMoversConfig each_scan() {
  UnknownMoversConfig config;
  config.every = 1;
  return config;
}

class Passing : public testing::Test {
 protected:
  // Scan by scan at 10 Hz; the last result.
  FoundMovers run(int num_scans, double length_m) {
    FoundMovers found;
    for (int i = 0; i < num_scans; ++i, ++scan_) {
      const std::vector<Point> scan = scan_of({kWallBehind, kPost, passing(length_m, -22.0 + scan_)});
      found = movers.update(0.1 * scan_, places(scan));
      movers.remember(ScanView(scan, SweepMotion::none(), SE3()));
    }
    return found;
  }

  UnknownMovers movers{each_scan(), FreeSpaceConfig{}};

 private:
  int scan_ = 0;
};

TEST_F(Passing, IsFoundWithItsVelocityAndNothingElseIs) {
  const FoundMovers found = run(25, 4.0);
  ASSERT_EQ(found.movers.size(), 1U);
  const UnknownMover& mover = found.movers[0];
  EXPECT_NEAR(mover.velocity_map_mps.x(), 0.0, 0.5);
  EXPECT_NEAR(mover.velocity_map_mps.y(), 10.0, 0.5);
  EXPECT_NEAR(mover.center_map.y(), 0.0, 0.5);
  EXPECT_NEAR(mover.size_m.y(), 4.0, 0.6);
  EXPECT_TRUE(found.columns.contains({20.1F, 0.0F, -2.0F}));
  EXPECT_FALSE(found.columns.contains({12.1F, 5.3F, 0.0F})) << "the post";
  EXPECT_FALSE(found.columns.contains({40.1F, 10.3F, 0.0F})) << "the wall";
}

TEST_F(Passing, AllThatFollowsTheFrontBelongsToIt) {
  const FoundMovers found = run(35, 100.0);
  ASSERT_EQ(found.movers.size(), 1U);
  for (const float y : {-5.2F, 0.2F, 5.2F, 11.2F})
    EXPECT_TRUE(found.columns.contains({20.1F, y, -2.0F})) << y;
}

TEST_F(Passing, ItsWayIsWhereItIsAndWhereItCameFrom) {
  const UnknownMover mover = run(25, 4.0).movers.at(0);  // from -2 to 2 m along y
  constexpr double kMargin_m = 0.5;                      // of the static map
  const auto is_on_way = [&](const Vector3d& p_map) {
    const Vector3d p_way = mover.T_map_way.inverse() * p_map;
    return (p_way.cwiseAbs().array() <= 0.5 * mover.way_lwh_m.array() + kMargin_m).all();
  };
  EXPECT_TRUE(is_on_way({20.1, 1.5, -2.0})) << "itself";
  EXPECT_TRUE(is_on_way({20.1, -20.0, -2.0})) << "two seconds before";
  EXPECT_FALSE(is_on_way({20.1, -26.0, -2.0})) << "three seconds before";
  EXPECT_FALSE(is_on_way({20.1, 4.0, -2.0})) << "ahead of it";
  EXPECT_FALSE(is_on_way({23.5, -10.0, -2.0})) << "beside its way";
  EXPECT_FALSE(is_on_way({20.1, -10.0, 1.0})) << "above its way";
}

TEST_F(Passing, KeepsItsIdentity) {
  const long id = run(20, 4.0).movers.at(0).id;
  EXPECT_EQ(run(5, 4.0).movers.at(0).id, id);
}

TEST_F(Passing, GoesOnFromAnArchive) {
  run(15, 4.0);
  ArchiveWriter writer;
  writer(movers);
  const FoundMovers expected = run(5, 4.0);

  UnknownMovers read(each_scan(), FreeSpaceConfig{});
  ArchiveReader(writer.bytes(), "archive")(read);
  FoundMovers found;
  for (int i = 15; i < 20; ++i) {
    const std::vector<Point> scan = scan_of({kWallBehind, kPost, passing(4.0, -22.0 + i)});
    found = read.update(0.1 * i, places(scan));
    read.remember(ScanView(scan, SweepMotion::none(), SE3()));
  }
  ASSERT_EQ(found.movers.size(), expected.movers.size());
  EXPECT_EQ(found.movers[0].id, expected.movers[0].id);
  EXPECT_EQ(found.movers[0].velocity_map_mps, expected.movers[0].velocity_map_mps);
}

TEST(UnknownMovers, WhatComesBeforeTheSkyAloneIsNotBelieved) {
  UnknownMovers movers(each_scan(), FreeSpaceConfig{});
  FoundMovers found;
  for (int i = 0; i < 25; ++i) {
    const std::vector<Point> scan = scan_of({kPost, passing(4.0, -22.0 + i)});
    found = movers.update(0.1 * i, places(scan));
    movers.remember(ScanView(scan, SweepMotion::none(), SE3()));
  }
  EXPECT_TRUE(found.movers.empty());
}

TEST(UnknownMovers, WithoutPointsOrScansToCompareNothingIsFound) {
  UnknownMovers movers(each_scan(), FreeSpaceConfig{});
  EXPECT_TRUE(movers.update(0.0, {}).movers.empty());
  const std::vector<Point> scan = scan_of({kWallBehind});
  EXPECT_TRUE(movers.update(0.1, places(scan)).movers.empty());
  for (int i = 0; i < 3; ++i) movers.remember(ScanView(scan, SweepMotion::none(), SE3()));
  EXPECT_TRUE(movers.update(0.2, {}).movers.empty());
  EXPECT_TRUE(movers.update(0.3, places(scan)).movers.empty());
}

}  // namespace
}  // namespace mlo
