#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "mlo/mapping/range_image.hpp"

namespace mlo {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Vector3f direction(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * kDegree;
  const double e = elevation_deg * kDegree;
  return Eigen::Vector3d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)).cast<float>();
}

/// A lidar with 32 scan lines within a vertical cylinder of this radius around it, ahead of which (azimuths
/// up to 10 degrees to both sides) stands a nearer wall.
std::vector<Point> round_room(double radius_m, double wall_m) {
  std::vector<Point> points;
  for (int ring = 0; ring < 32; ++ring) {
    for (int step = 0; step < 1800; ++step) {
      const double azimuth_deg = -180.0 + 0.2 * step;
      const double elevation_deg = 10.0 - 0.7 * ring;
      const double horizontal_m = std::abs(azimuth_deg) <= 10.0 ? wall_m : radius_m;
      Point point;
      point.p_lidar = direction(azimuth_deg, elevation_deg) *
                      static_cast<float>(horizontal_m / std::cos(elevation_deg * kDegree));
      point.ring = static_cast<std::uint16_t>(ring);
      point.sweep_fraction = static_cast<float>(step) / 1800.0F;
      points.push_back(point);
    }
  }
  return points;
}

TEST(RangeImage, TellsWhatIsSeenFromWhatIsSeenThroughAndWhatIsHidden) {
  const RangeImage image(round_room(20.0, 8.0));
  EXPECT_EQ(image.look(20.0F * direction(90.0, 0.0), 0.3F), Sight::hit);
  EXPECT_EQ(image.look(12.0F * direction(90.0, 0.0), 0.3F), Sight::through);
  EXPECT_EQ(image.look(25.0F * direction(90.0, 0.0), 0.3F), Sight::unknown);
  EXPECT_EQ(image.look(8.0F * direction(0.0, 0.0), 0.3F), Sight::hit);
  EXPECT_EQ(image.look(12.0F * direction(0.0, 0.0), 0.3F), Sight::unknown) << "behind the wall";
}

TEST(RangeImage, WorksAcrossTheSeamBehindTheLidar) {
  const RangeImage image(round_room(20.0, 8.0));
  for (const double azimuth_deg : {179.99, -179.99, 180.0}) {
    EXPECT_EQ(image.look(12.0F * direction(azimuth_deg, 0.0), 0.3F), Sight::through) << azimuth_deg;
  }
}

TEST(RangeImage, BesideTheRimOfANearerSurfaceNothingLooksFree) {
  const RangeImage image(round_room(20.0, 8.0));
  EXPECT_EQ(image.look(7.9F * direction(10.1, 0.0), 0.3F), Sight::unknown);
  EXPECT_EQ(image.look(7.9F * direction(12.0, 0.0), 0.3F), Sight::through);
}

/// Straight ahead, below the lidar, from 6 to 9 m: scan lines meet it at 6.1, 7.0 and 8.2 m.
constexpr float kRoofM = -0.6F;
std::vector<Point> room_with_roof(bool is_there) {
  std::vector<Point> room = round_room(20.0, 20.0);
  for (Point& point : room) {
    const float along_m = point.p_lidar.head<2>().norm() * kRoofM / point.p_lidar.z();
    const bool ahead = point.p_lidar.x() > 0.0F && std::abs(point.p_lidar.y()) < 0.17F * point.p_lidar.x();
    if (is_there && ahead && along_m > 6.0F && along_m < 9.0F) point.p_lidar *= kRoofM / point.p_lidar.z();
  }
  return room;
}

TEST(RangeImage, ASurfaceAtAGrazingAngleIsNotSeenThrough) {
  const RangeImage there(room_with_roof(true));
  const RangeImage gone(room_with_roof(false));
  int seen = 0;
  for (float x_m = 6.5F; x_m < 8.9F; x_m += 0.1F) {
    EXPECT_NE(there.look({x_m, 0.0F, kRoofM}, 0.24F), Sight::through) << x_m;
    EXPECT_EQ(gone.look({x_m, 0.0F, kRoofM}, 0.24F), Sight::through) << x_m;
    seen += there.look({x_m, 0.0F, kRoofM}, 0.24F) == Sight::hit ? 1 : 0;
  }
  EXPECT_GT(seen, 0);
}

// With as few points in a line, fine columns would have no rays.
TEST(RangeImage, SeesThroughToTheWallWithCoarseScanLinesToo) {
  std::vector<Point> room = round_room(20.0, 20.0);
  std::vector<Point> coarse;
  for (std::size_t i = 0; i < room.size(); i += 4) coarse.push_back(room[i]);
  const RangeImage image(coarse);
  for (double azimuth_deg = -180.0; azimuth_deg < 180.0; azimuth_deg += 0.37) {
    EXPECT_EQ(image.look(12.0F * direction(azimuth_deg, 0.1), 0.3F), Sight::through) << azimuth_deg;
  }
}

TEST(RangeImage, SaysNothingWhereNoRayWent) {
  const RangeImage image(round_room(20.0, 8.0));
  EXPECT_EQ(image.look(12.0F * direction(90.0, 45.0), 0.3F), Sight::unknown);
  EXPECT_EQ(image.look(12.0F * direction(90.0, -45.0), 0.3F), Sight::unknown);
  const RangeImage empty({});
  EXPECT_EQ(empty.look(direction(0.0, 0.0), 0.3F), Sight::unknown);
  EXPECT_EQ(empty.sweep_fraction(direction(0.0, 0.0)), 0.5F);
}

/// The room with a gap from 10 degrees to the left to 10 degrees to the right, above an elevation.
RangeImage room_open_above(double elevation_deg) {
  std::vector<Point> room = round_room(20.0, 8.0);
  const auto lowest = static_cast<float>(std::tan(elevation_deg * kDegree));
  std::erase_if(room, [&](const Point& point) {
    const Eigen::Vector3f& p = point.p_lidar;
    const bool ahead = p.x() > 0.0F && std::abs(p.y()) < 0.17F * p.x();
    return ahead && p.z() > lowest * p.head<2>().norm();
  });
  return RangeImage(room);
}

TEST(RangeImage, AboveTheHighestRaysIsTheSky) {
  const RangeImage image = room_open_above(0.0);
  EXPECT_EQ(image.look(7.0F * direction(0.0, 3.0), 0.3F), Sight::sky);
  EXPECT_EQ(image.look(7.0F * direction(0.0, 9.0), 0.3F), Sight::sky);
  EXPECT_NE(image.look(7.0F * direction(0.0, 0.1), 0.3F), Sight::sky) << "beside rays that came back";
  EXPECT_EQ(image.look(7.0F * direction(9.5, 3.0), 0.3F), Sight::unknown) << "beside rays that came back";
  EXPECT_EQ(image.look(7.0F * direction(0.0, -3.0), 0.3F), Sight::through);
}

TEST(RangeImage, WhatIsBelowRaysThatCameBackIsNotTheSky) {
  std::vector<Point> room = round_room(20.0, 8.0);
  std::erase_if(room, [](const Point& point) {
    const float elevation = point.p_lidar.z() / point.p_lidar.head<2>().norm();
    return point.p_lidar.x() > 0.0F && elevation > -0.1F && elevation < 0.1F;
  });
  EXPECT_EQ(RangeImage(room).look(7.0F * direction(0.0, 0.0), 0.3F), Sight::empty) << "a dark band";
}

TEST(RangeImage, WhereNoRayWentAtAllIsNotTheSky) {
  std::vector<Point> room = round_room(20.0, 8.0);
  std::erase_if(room, [](const Point& point) { return point.p_lidar.x() < 0.0F; });
  EXPECT_EQ(RangeImage(room).look(7.0F * direction(180.0, 3.0), 0.3F), Sight::empty) << "cropped";
}

TEST(RangeImage, WhereNoRayAroundCameBackItIsEmpty) {
  std::vector<Point> room = round_room(20.0, 8.0);
  std::erase_if(room, [](const Point& point) {
    return point.p_lidar.x() > 0.0F && std::abs(point.p_lidar.y()) < 0.5F * point.p_lidar.x();
  });
  const RangeImage image(room);
  EXPECT_EQ(image.look(7.0F * direction(0.0, 0.0), 0.3F), Sight::empty);
  EXPECT_EQ(image.look(7.0F * direction(26.3, 0.0), 0.3F), Sight::unknown) << "beside rays that came back";
}

TEST(RangeImage, KnowsWhenTheLidarLookedInADirection) {
  const RangeImage image(round_room(20.0, 8.0));
  EXPECT_NEAR(image.sweep_fraction(direction(-90.0, 0.0)), 0.25, 0.002);
  EXPECT_NEAR(image.sweep_fraction(direction(90.0, -5.0)), 0.75, 0.002);
}

TEST(RangeImage, ScanLinesOnTheGroundSpreadWithTheSquareOfTheRange) {
  const RangeImage image(round_room(20.0, 8.0));
  const double near_m = image.step_on_ground_m({10.0, 0.0, -1.7});
  EXPECT_NEAR(near_m, 100.0 / 1.7 * 0.7 * kDegree, 0.2 * near_m);
  EXPECT_NEAR(image.step_on_ground_m({20.0, 0.0, -1.7}) / near_m, 4.0, 0.2);
}

}  // namespace
}  // namespace mlo
