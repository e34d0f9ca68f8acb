#include <gtest/gtest.h>

#include "mlo/io/dataset.hpp"
#include "mlo/perception/ground.hpp"
#include "mlo/perception/perceive.hpp"
#include "real_data.hpp"

namespace mlo {
namespace {

TEST(Perceive, AnEmptyScanGivesNothing) {
  const Percept seen = perceive({}, {}, {});
  EXPECT_TRUE(seen.ground.candidates.empty());
  EXPECT_TRUE(seen.edge.candidates.empty());
  EXPECT_TRUE(seen.surface.candidates.empty());
  EXPECT_TRUE(seen.objects.empty());
  EXPECT_EQ(seen.mean_ground_smoothness, 0.0);
}

struct RealSequence {
  const char* folder;
  const char* sequence;
};

class PerceiveReal : public testing::TestWithParam<RealSequence> {};

TEST_P(PerceiveReal, FindsTheRoadAndEnoughFeatures) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const Dataset dataset = open_dataset(*data / GetParam().folder, {.sequence = GetParam().sequence});
  for (std::size_t frame = 0; frame < 50; frame += 10) {
    const ScanReading reading = dataset.scans->read(frame);
    ASSERT_TRUE(reading.scan) << reading.problem;
    const GroundSegmentation ground = segment_ground(reading.scan->points, {});
    EXPECT_NEAR(ground.nearby.offset_m, 1.73, 0.2);
    const Percept seen = perceive(*reading.scan, {}, {});
    const double share =
        static_cast<double>(seen.num_ground_points) / static_cast<double>(reading.scan->points.size());
    EXPECT_GT(share, 0.3);
    EXPECT_LT(share, 0.9);
    EXPECT_GT(seen.ground.features.size(), 500U);
    EXPECT_GT(seen.edge.features.size(), 200U);
    EXPECT_GT(seen.surface.features.size(), 200U);
    const std::size_t candidates =
        seen.ground.candidates.size() + seen.edge.candidates.size() + seen.surface.candidates.size();
    EXPECT_GT(candidates, 10000U);
    EXPECT_LT(candidates, 60000U);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sequences, PerceiveReal,
    testing::Values(RealSequence{"kitti_odometry", "01"}, RealSequence{"kitti_odometry", "04"},
                    RealSequence{"kitti_raw/2011_09_26/2011_09_26_drive_0005_sync", ""}));

}  // namespace
}  // namespace mlo
