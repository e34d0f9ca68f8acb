#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "detection/made_scan.hpp"
#include "mlo/core/box_overlap.hpp"
#include "mlo/detection/cluster_detector.hpp"

namespace mlo {
namespace {

const Eigen::Vector3d kCarSize(4.1, 1.75, 1.5);

/// The candidate of a class that is most like the true box.
Candidate best_of(const std::vector<Candidate>& candidates, ObjectClass object_class, const Box3d& truth) {
  Candidate best;
  double best_iou = -1.0;
  for (const Candidate& candidate : candidates) {
    const double iou = intersection_over_union(candidate.box, truth);
    if (candidate.object_class != object_class || iou <= best_iou) continue;
    best_iou = iou;
    best = candidate;
  }
  return best;
}

std::vector<Candidate> candidates_around(const Box3d& box) {
  test::MadeScan scan;
  scan.add_ground({box});
  scan.add_box(box);
  return find_candidates(scan.points, scan.is_ground, {});
}

TEST(Candidates, OfACarFromAllSides) {
  for (double azimuth = -3.0; azimuth < 3.0; azimuth += 0.7) {
    const Box3d truth = test::standing(14.0 * std::cos(azimuth), 14.0 * std::sin(azimuth), kCarSize, 0.4);
    const Candidate best = best_of(candidates_around(truth), ObjectClass::car, truth);
    EXPECT_GT(intersection_over_union(best.box, truth), 0.8) << "azimuth " << azimuth;
    EXPECT_NEAR(best.features[3], 0.25, 0.06);               // bottom
    EXPECT_LT(best.features[6], 0.5);                        // off_sides
    EXPECT_LT(best.features[11] + best.features[12], 1e-9);  // crowded, others
    EXPECT_LT(best.features[13], 0.1);                       // ground_inside
  }
}

TEST(Candidates, AddWhatIsNotSeenAwayFromTheLidar) {
  // Only its rear is seen, straight ahead.
  const Box3d truth = test::standing(20.0, 0.0, kCarSize, 0.0);
  const Candidate best = best_of(candidates_around(truth), ObjectClass::car, truth);
  EXPECT_GT(best.box.center_lidar_m.x(), 19.5);
  EXPECT_NEAR(std::remainder(best.box.yaw_rad, std::numbers::pi), 0.0, 0.05);
  EXPECT_NEAR(best.box.center_lidar_m.z() - 0.5 * best.box.size_lwh_m.z(), -test::kLidarHeight_m, 0.02);
}

TEST(Candidates, NoneOfWallsAndOfNothing) {
  test::MadeScan scan;
  scan.add_ground({});
  for (double x = -20.0; x < 20.0; x += 0.1) {
    for (double z = -1.5; z < 1.0; z += 0.3) scan.add({x, 8.0, z});
  }
  EXPECT_TRUE(find_candidates(scan.points, scan.is_ground, {}).empty());
  EXPECT_TRUE(find_candidates({}, {}, {}).empty());
  test::MadeScan no_ground;
  no_ground.add_box(test::standing(10.0, 0.0, kCarSize, 0.0));
  EXPECT_TRUE(find_candidates(no_ground.points, no_ground.is_ground, {}).empty());
}

}  // namespace
}  // namespace mlo
