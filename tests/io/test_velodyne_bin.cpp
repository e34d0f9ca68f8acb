#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/synthetic_sweep.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/velodyne_bin.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

Point point_at(float x, float y, float z, float intensity) {
  Point point;
  point.p_lidar = {x, y, z};
  point.intensity = intensity;
  return point;
}

TEST(ReadVelodyneBin, RoundTrip) {
  const test::TempFolder folder;
  const std::vector<Point> points{point_at(1.0F, -2.0F, 3.5F, 0.25F), point_at(-70.125F, 0.0F, 1e-3F, 0.99F)};
  const PointCloudFile read = read_velodyne_bin(folder.write("scan.bin", test::to_bin(points)));
  ASSERT_EQ(read.points.size(), 2U);
  EXPECT_EQ(read.invalid_points, 0U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.points[i].p_lidar, points[i].p_lidar);
    EXPECT_EQ(read.points[i].intensity, points[i].intensity);
    EXPECT_EQ(read.points[i].ring, Point::kNoRing);
  }
}

TEST(ReadVelodyneBin, LeavesOutWhatIsNotFinite) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const test::TempFolder folder;
  const auto file = folder.write(
      "scan.bin", test::to_bin({point_at(kNan, 0.0F, 0.0F, 0.0F), point_at(1.0F, 2.0F, 3.0F, 0.5F),
                                point_at(0.0F, 0.0F, -kInf, 0.0F)}));
  const PointCloudFile read = read_velodyne_bin(file);
  ASSERT_EQ(read.points.size(), 1U);
  EXPECT_EQ(read.points.front().p_lidar, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  EXPECT_EQ(read.invalid_points, 2U);
}

TEST(ReadVelodyneBin, EmptyFileHasNoPoints) {
  const test::TempFolder folder;
  EXPECT_TRUE(read_velodyne_bin(folder.write("scan.bin", "")).points.empty());
}

TEST(ReadVelodyneBin, TellsWhatIsWrongWithTheFile) {
  const test::TempFolder folder;
  const auto truncated = folder.write("scan.bin", std::string(37, 'x'));
  EXPECT_THAT([&] { read_velodyne_bin(truncated); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::HasSubstr("scan.bin"), testing::HasSubstr("37 bytes"))));
  EXPECT_THROW(read_velodyne_bin(folder.path() / "none.bin"), InputError);
  EXPECT_THROW(read_velodyne_bin(folder.path()), InputError);
}

}  // namespace
}  // namespace mlo
