#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "mlo/loops/place_descriptor.hpp"

namespace mlo {
namespace {

/// Walls of different heights all around, whose distances depend on the place.
std::vector<Eigen::Vector3f> walls(int place, double yaw_rad) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 3600; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * i / 3600.0;
    const double range =
        20.0 + 10.0 * std::sin((2 + place) * azimuth) + 5.0 * std::cos((5 - place) * azimuth);
    const double height = 3.0 + 2.0 * std::sin((3 + place) * azimuth);
    for (double z = -1.7; z < height; z += 0.5) {
      points.push_back(
          Eigen::Vector3d(range * std::cos(azimuth - yaw_rad), range * std::sin(azimuth - yaw_rad), z)
              .cast<float>());
    }
  }
  return points;
}

TEST(PlaceDescriptor, APlaceIsKnownInAnyHeading) {
  const PlaceDescriptor first(walls(0, 0.0));
  for (const double yaw_rad : {0.0, 0.1, 1.0, 2.5, -3.0}) {
    const PlaceDifference difference = compare(first, PlaceDescriptor(walls(0, yaw_rad)));
    EXPECT_LT(difference.value, 0.15) << yaw_rad;
    EXPECT_LT(std::abs(std::remainder(difference.yaw_rad - yaw_rad, 2.0 * std::numbers::pi)), 0.06)
        << yaw_rad;
  }
  EXPECT_GT(compare(first, PlaceDescriptor(walls(1, 0.0))).value, 0.4);
}

TEST(PlaceDescriptor, TheHighestPointCounts) {
  const std::vector<Eigen::Vector3f> points{{10.0F, 0.1F, 1.0F},
                                            {10.0F, 0.1F, -1.0F},
                                            {100.0F, 0.0F, 5.0F},
                                            {std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F}};
  const PlaceDescriptor place(points);
  EXPECT_EQ(place.heights_m().sum(), 3.0F);
  EXPECT_EQ(place.heights_m()(2, PlaceDescriptor::kSectors / 2), 3.0F);
}

TEST(PlaceDescriptor, NothingIsLikeNothing) {
  EXPECT_EQ(compare(PlaceDescriptor(), PlaceDescriptor()).value, 1.0);
  EXPECT_EQ(compare(PlaceDescriptor(walls(0, 0.0)), PlaceDescriptor()).value, 1.0);
}

}  // namespace
}  // namespace mlo
