#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "detection/made_scan.hpp"
#include "mlo/core/box_overlap.hpp"
#include "mlo/detection/cluster_detector.hpp"

namespace mlo {
namespace {

TEST(DetectClusters, FindsCarsAndRejectsTheRest) {
  const test::MadeScan scan = test::street_with(test::kParkedCars);
  ClusterConfig config;
  config.min_candidate = 0.5;
  const auto found = detect_clusters(scan.points, scan.is_ground, config);
  for (const Box3d& car : test::kParkedCars) {
    const auto is_it = [&](const Detection& detection) {
      return detection.object_class == ObjectClass::car && intersection_over_union(detection.box, car) > 0.6;
    };
    EXPECT_EQ(std::ranges::count_if(found, is_it), 1);
  }
  EXPECT_EQ(found.size(), test::kParkedCars.size());
  for (std::size_t i = 1; i < found.size(); ++i) EXPECT_GE(found[i - 1].confidence, found[i].confidence);
}

TEST(DetectClusters, DoesNotDependOnThreads) {
  const test::MadeScan scan = test::street_with(test::kParkedCars);
  ClusterConfig config;
  config.min_candidate = 0.01;
  const auto many = detect_clusters(scan.points, scan.is_ground, config);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const auto single = detect_clusters(scan.points, scan.is_ground, config);
  ASSERT_EQ(many.size(), single.size());
  for (std::size_t i = 0; i < many.size(); ++i) {
    EXPECT_EQ(many[i].confidence, single[i].confidence);
    EXPECT_EQ(many[i].box.center_lidar_m, single[i].box.center_lidar_m);
  }
}

}  // namespace
}  // namespace mlo
