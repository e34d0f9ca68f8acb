#include <gtest/gtest.h>

#include "mlo/tracking/ego_from_boxes.hpp"
#include "tracking/boxes.hpp"

namespace mlo {
namespace {

using test::kDegree;

/// Pairs of standing objects, seen from a pose.
std::vector<BoxPair> standing(const SE3& T_map_lidar) {
  std::vector<BoxPair> pairs;
  for (const Eigen::Vector3d& p_map : {Eigen::Vector3d(20.0, 5.0, 0.0), Eigen::Vector3d(30.0, -6.0, 0.0),
                                       Eigen::Vector3d(12.0, -4.0, 0.0), Eigen::Vector3d(45.0, 8.0, 0.0)}) {
    const Eigen::Vector3d p_lidar = T_map_lidar.inverse() * p_map;
    pairs.push_back({p_lidar.head<2>(), p_map.head<2>(), 0.1});
  }
  return pairs;
}

TEST(EgoFromBoxes, FindsThePoseFromStandingObjects) {
  const SE3 truth(so3_exp({0.0, 0.0, 1.5 * kDegree}), {1.2, 0.1, 0.0});
  const SE3 predicted(Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0});
  const SE3 error = truth.inverse() *
                    ego_from_boxes(standing(truth), predicted, {.translation_m = 5.0, .rotation_rad = 1.0});
  EXPECT_LT(error.translation().norm(), 1e-3);
  EXPECT_LT(error.rotation_angle_rad(), 1e-4);
}

TEST(EgoFromBoxes, OneThatLeftItsCourseIsLeftOut) {
  const SE3 truth(so3_exp({0.0, 0.0, 0.5 * kDegree}), {1.0, 0.0, 0.0});
  std::vector<BoxPair> pairs = standing(truth);
  pairs.push_back({{15.0, 0.0}, {18.0, 0.0}, 0.1});  // 2 m off
  const SE3 error =
      truth.inverse() * ego_from_boxes(pairs, SE3(Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}), {});
  EXPECT_LT(error.translation().norm(), 0.03);
}

TEST(EgoFromBoxes, WithoutPairsThePredictionStands) {
  const SE3 predicted(so3_exp({0.01, 0.02, 0.3}), {4.0, 5.0, 6.0});
  const SE3 pose = ego_from_boxes({}, predicted, {});
  EXPECT_TRUE(pose.matrix().isApprox(predicted.matrix(), 1e-12));
}

TEST(EgoFromBoxes, OnePairMovesItAlongWithThePrior) {
  const std::vector<BoxPair> pairs{{{10.0, 0.0}, {10.1, 0.0}, 0.1}};
  const SE3 pose = ego_from_boxes(pairs, SE3(), {.translation_m = 0.1, .rotation_rad = 0.01});
  EXPECT_NEAR(pose.translation().x(), 0.05, 0.01) << "as sure of one as of the other: half way";
  EXPECT_NEAR(pose.translation().y(), 0.0, 1e-9);
}

}  // namespace
}  // namespace mlo
