#include <cmath>

#include <gtest/gtest.h>

#include "mlo/learning/targets.hpp"
#include "mlo/network/box_code.hpp"
#include "network/tiny_network.hpp"

namespace mlo {
namespace {

const NetworkArchitecture kKnown = test::tiny_architecture();
const Box3d kCar{{10.0, 2.0, 0.75}, {4.0, 1.8, 1.5}, 0.4};

PointRows one_row(const Eigen::Vector3d& p) {
  PointRows rows(1, 3);
  rows.row(0) = p.transpose().cast<float>();
  return rows;
}

TEST(Centerness, IsOneInTheMiddleAndZeroOutside) {
  EXPECT_DOUBLE_EQ(centerness(kCar, kCar.center_lidar_m), 1.0);
  // A quarter of the length ahead of the middle: 1 m to the front, 3 m to the back.
  EXPECT_NEAR(centerness(kCar, kCar.T_lidar_object() * Eigen::Vector3d(1.0, 0.0, 0.0)), std::cbrt(1.0 / 3.0),
              1e-9);
  EXPECT_NEAR(centerness(kCar, kCar.T_lidar_object() * Eigen::Vector3d(2.0, 0.0, 0.0)), 0.0, 1e-4);
  EXPECT_DOUBLE_EQ(centerness(kCar, {0.0, 0.0, 0.0}), 0.0);
}

TEST(AssignTargets, TellsObjectBackgroundAndDoubt) {
  const std::vector<TargetBox> boxes{{kCar, 0},
                                     {{{-8.0, 0.0, 0.9}, {0.6, 0.6, 1.8}, 0.0}, TargetBox::kIgnored}};
  const auto class_at = [&](const Eigen::Vector3d& p) {
    return assign_targets(one_row(p), one_row(p), boxes, kKnown).class_index.front();
  };
  EXPECT_EQ(class_at(kCar.center_lidar_m), 0);
  EXPECT_EQ(class_at(kCar.T_lidar_object() * Eigen::Vector3d(2.2, 0.0, 0.0)), CandidateTargets::kIgnored);
  EXPECT_EQ(class_at(kCar.T_lidar_object() * Eigen::Vector3d(3.0, 0.0, 0.0)), CandidateTargets::kBackground);
  EXPECT_EQ(class_at({-8.0, 0.0, 0.9}), CandidateTargets::kIgnored);
  EXPECT_EQ(class_at({0.0, 0.0, 0.0}), CandidateTargets::kBackground);
}

TEST(AssignTargets, SaysTheBoxAsTheNetworkWould) {
  const Eigen::Vector3d candidate = kCar.T_lidar_object() * Eigen::Vector3d(0.5, -0.3, 0.1);
  const Eigen::Vector3d origin = kCar.T_lidar_object() * Eigen::Vector3d(1.9, 0.8, 0.2);
  const CandidateTargets targets =
      assign_targets(one_row(origin), one_row(candidate), std::vector<TargetBox>{{kCar, 0}}, kKnown);
  Eigen::RowVectorXf code = Eigen::RowVectorXf::Zero(kKnown.box_code.size());
  code.head<6>() = targets.codes.row(0);
  code[6 + targets.angle_bin[0]] = 1.0F;
  code[6 + kKnown.box_code.angle_bins + targets.angle_bin[0]] = targets.angle_residual[0];
  const Box3d decoded = decode_box(code, candidate, 0, kKnown);
  EXPECT_LT((decoded.center_lidar_m - kCar.center_lidar_m).norm(), 1e-5);
  EXPECT_LT((decoded.size_lwh_m - kCar.size_lwh_m).norm(), 1e-5);
  EXPECT_NEAR(decoded.yaw_rad, kCar.yaw_rad, 1e-6);
  EXPECT_EQ(targets.is_on_object[0], 1);
  EXPECT_LT((targets.shifts.row(0).transpose().cast<double>() - (kCar.center_lidar_m - origin)).norm(), 1e-5);
}

TEST(AssignTargets, HandlesNothing) {
  EXPECT_TRUE(assign_targets(PointRows(0, 3), PointRows(0, 3), {}, kKnown).class_index.empty());
  EXPECT_EQ(assign_targets(PointRows::Zero(1, 3), PointRows::Zero(1, 3), {}, kKnown).class_index.front(),
            CandidateTargets::kBackground);
}

}  // namespace
}  // namespace mlo
