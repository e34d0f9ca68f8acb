#include <bit>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mlo/io/dataset.hpp"
#include "mlo/perception/ground.hpp"
#include "mlo/perception/perceive.hpp"
#include "perception/synthetic_scan.hpp"
#include "real_data.hpp"

namespace mlo {
namespace {

std::size_t count_candidates(const Percept& seen) {
  return seen.ground.candidates.size() + seen.edge.candidates.size() + seen.surface.candidates.size();
}

/// Everything in a list of features, bit by bit.
void append(const std::vector<FeaturePoint>& features, std::vector<std::uint32_t>& bits) {
  bits.push_back(static_cast<std::uint32_t>(features.size()));
  for (const FeaturePoint& f : features) {
    for (const float value : {f.p_lidar.x(), f.p_lidar.y(), f.p_lidar.z(), f.sweep_fraction, f.smoothness}) {
      bits.push_back(std::bit_cast<std::uint32_t>(value));
    }
    bits.push_back(f.ring);
  }
}

std::vector<std::uint32_t> bits_of(const Percept& seen) {
  std::vector<std::uint32_t> bits;
  for (const FeatureSet* set : {&seen.ground, &seen.edge, &seen.surface}) {
    append(set->features, bits);
    append(set->candidates, bits);
  }
  for (const ObjectPoints& object : seen.objects) {
    append(object.edge_candidates, bits);
    for (const Point& p : object.points) bits.push_back(std::bit_cast<std::uint32_t>(p.p_lidar.x()));
  }
  return bits;
}

TEST(Perceive, AnEmptyScanGivesNothing) {
  const Percept seen = perceive({}, std::vector<Detection>(1), {});
  EXPECT_EQ(count_candidates(seen), 0U);
  ASSERT_EQ(seen.objects.size(), 1U);
  EXPECT_TRUE(seen.objects[0].points.empty());
  EXPECT_EQ(seen.mean_ground_smoothness, 0.0);
}

TEST(Perceive, OnePointIsOneCandidate) {
  Scan scan;
  scan.points.resize(1);
  scan.points[0].ring = 3;
  EXPECT_EQ(count_candidates(perceive(scan, {}, {})), 1U);
}

TEST(Perceive, GroundAndObjectCorrectEachOther) {
  const test::Scene scene = test::street(1.73);
  const test::SyntheticScan synthetic = test::make_scan(scene);
  const std::vector<Detection> detections{{.box = scene.boxes[0]}, {.box = scene.boxes[1]}};
  const Percept without = perceive(synthetic.scan, {}, {});
  const Percept with = perceive(synthetic.scan, detections, {});
  ASSERT_EQ(with.objects.size(), 2U);
  EXPECT_GT(with.num_ambiguous_points, 0U);
  EXPECT_EQ(without.num_ground_points, with.num_ground_points + with.num_ambiguous_points);
  std::size_t in_boxes = 0;
  for (const Point& point : synthetic.scan.points) {
    const Eigen::Vector3d p = point.p_lidar.cast<double>();
    in_boxes += detections[0].box.contains(p, 0.1) || detections[1].box.contains(p, 0.1);
  }
  EXPECT_EQ(with.objects[0].points.size() + with.objects[1].points.size() + with.num_ambiguous_points,
            in_boxes);
  for (const ObjectPoints& object : with.objects) {
    EXPECT_GT(object.points.size(), 100U);
    EXPECT_FALSE(object.edge_candidates.empty());
    for (const Point& point : object.points) EXPECT_GT(point.p_lidar.z(), -1.73F + 0.15F);
    for (const FeatureSet* set : {&with.ground, &with.edge, &with.surface}) {
      for (const FeaturePoint& f : set->candidates) {
        ASSERT_FALSE(object.detection.box.contains(f.p_lidar.cast<double>(), 0.1));
      }
    }
  }
}

TEST(Perceive, WithoutRingsThereAreNoEdgesButGroundAndSurfaces) {
  test::SyntheticScan synthetic = test::make_scan(test::street(1.73));
  const Percept with_rings = perceive(synthetic.scan, {}, {});
  for (Point& point : synthetic.scan.points) point.ring = Point::kNoRing;
  const Percept seen = perceive(synthetic.scan, {}, {});
  EXPECT_TRUE(seen.edge.features.empty());
  EXPECT_TRUE(seen.edge.candidates.empty());
  EXPECT_EQ(seen.ground.candidates.size(), with_rings.ground.candidates.size());
  EXPECT_GE(seen.surface.candidates.size(), with_rings.surface.candidates.size());
  EXPECT_GT(seen.ground.features.size(), 100U);
  EXPECT_LT(seen.ground.features.size(), seen.ground.candidates.size() / 2);
  EXPECT_GT(seen.surface.features.size(), 20U);
}

TEST(Perceive, CarriesTimeIntensityAndRing) {
  test::SyntheticScan synthetic = test::make_scan(test::street(1.73));
  for (std::size_t i = 0; i < synthetic.scan.points.size(); ++i) {
    Point& point = synthetic.scan.points[i];
    point.sweep_fraction = point.p_lidar.x();  // anything that can be told from the point alone
    point.intensity = point.p_lidar.y();
  }
  const Percept seen = perceive(synthetic.scan, {}, {});
  for (const FeatureSet* set : {&seen.ground, &seen.edge, &seen.surface}) {
    for (const std::vector<FeaturePoint>* features : {&set->features, &set->candidates}) {
      ASSERT_FALSE(features->empty());
      for (const FeaturePoint& f : *features) {
        ASSERT_EQ(f.sweep_fraction, f.p_lidar.x());
        ASSERT_EQ(f.intensity, f.p_lidar.y());
        ASSERT_LT(f.ring, 64);
      }
    }
  }
}

TEST(Perceive, DoesNotDependOnTheNumberOfThreads) {
  const test::Scene scene = test::street(1.73);
  const test::SyntheticScan synthetic = test::make_scan(scene);
  const std::vector<Detection> detections{{.box = scene.boxes[0]}, {.box = scene.boxes[1]}};
  std::vector<std::vector<std::uint32_t>> results;
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(bits_of(perceive(synthetic.scan, detections, {})));
  }
  EXPECT_EQ(results[0], results[1]);
}

struct RealSequence {
  const char* name;
  const char* folder;
  const char* sequence;
};

class PerceiveReal : public testing::TestWithParam<RealSequence> {};

TEST_P(PerceiveReal, FindsTheRoadAndEnoughFeatures) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  const Dataset dataset = open_dataset(*data / GetParam().folder, {.sequence = GetParam().sequence});
  for (std::size_t index = 0; index < 50; index += 7) {
    SCOPED_TRACE(index);
    const ScanReading reading = dataset.scans->read(index);
    ASSERT_TRUE(reading.scan) << reading.problem;
    EXPECT_NEAR(segment_ground(reading.scan->points, {}).nearby.offset_m, 1.73, 0.15);
    const Percept seen = perceive(*reading.scan, {}, {});
    const double share =
        static_cast<double>(seen.num_ground_points) / static_cast<double>(reading.scan->points.size());
    EXPECT_GT(share, 0.3);
    EXPECT_LT(share, 0.85);  // an empty motorway is nearly all road
    EXPECT_GT(seen.ground.features.size(), 500U);
    EXPECT_LT(seen.ground.features.size(), 1600U);
    // Noise of smooth surfaces is no edge (min_edge_smoothness): the motorway has some 200 poles and rims.
    EXPECT_GT(seen.edge.features.size(), 150U);
    EXPECT_LT(seen.edge.features.size(), 1600U);
    EXPECT_GT(seen.surface.features.size(), 250U);
    EXPECT_LT(seen.surface.features.size(), 1900U);
    EXPECT_GT(count_candidates(seen), 15000U);
    EXPECT_LT(count_candidates(seen), 50000U);
    EXPECT_GT(seen.mean_ground_smoothness, 0.0);
    EXPECT_LT(seen.mean_ground_smoothness, 0.005);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sequences, PerceiveReal,
    testing::Values(RealSequence{"Motorway01", "kitti_odometry", "01"},
                    RealSequence{"Road04", "kitti_odometry", "04"},
                    RealSequence{"City0005", "kitti_raw/2011_09_26/2011_09_26_drive_0005_sync", ""},
                    RealSequence{"City0009", "kitti_raw/2011_09_26/2011_09_26_drive_0009_sync", ""}),
    [](const testing::TestParamInfo<RealSequence>& sequence) { return sequence.param.name; });

}  // namespace
}  // namespace mlo
