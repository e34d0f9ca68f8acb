#include <limits>

#include <gtest/gtest.h>

#include "mlo/tracking/sgf_solver.hpp"
#include "tracking/boxes.hpp"
#include "tracking/car_scan.hpp"

namespace mlo {
namespace {

using test::kDegree;

/// A car seen twice; H is its true relative motion.
struct TwoLooks {
  SE3 L_before{so3_exp({0.0, 0.0, 20.0 * kDegree}), {15.0, 4.0, -0.9}};
  SE3 H{so3_exp({0.0, 0.0, 1.5 * kDegree}), {-0.8, 0.15, 0.02}};
  ObjectTarget target;
  std::vector<ShapedPoint> points;
  Box3d before;
  Box3d now;

  explicit TwoLooks(double noise_m) {
    const SE3 L_now = H.inverse() * L_before;
    target =
        ObjectTarget(shaped_points(test::seen_from_lidar(L_before, noise_m, 1), {}), SgfConfig{}.voxel_m);
    points = shaped_points(test::seen_from_lidar(L_now, noise_m, 2), {});
    before = {L_before.translation(), {4.0, 1.6, 1.4}, 20.0 * kDegree};
    now = {L_now.translation(), {4.0, 1.6, 1.4}, 18.5 * kDegree};
  }
  SgfProblem problem() const {
    return {.target = &target, .points = points, .previous_box = before, .current_box = now};
  }
  /// Error at the object, where it counts.
  double position_error_m(const PoseEstimate& estimate) const {
    return (estimate.T_target_source * now.center_lidar_m - H * now.center_lidar_m).norm();
  }
  double rotation_error_rad(const PoseEstimate& estimate) const {
    return (H.inverse() * estimate.T_target_source).rotation_angle_rad();
  }
};

SgfConfig with_mode(SgfMode mode) {
  SgfConfig config;
  config.mode = mode;
  return config;
}

TEST(SgfSolver, BoxesAloneGiveTheMotionOfTheBoxes) {
  const TwoLooks looks(0.0);
  const PoseEstimate estimate =
      estimate_relative_motion(looks.problem(), SE3(), with_mode(SgfMode::semantic));
  EXPECT_EQ(estimate.status, EstimateStatus::converged);
  EXPECT_LT(looks.position_error_m(estimate), 2e-3);
  EXPECT_LT(looks.rotation_error_rad(estimate), 1e-3);
  EXPECT_EQ(estimate.num_matches, 0U);
}

TEST(SgfSolver, PointsAloneGiveTheMotionFromANearGuess) {
  const TwoLooks looks(0.01);
  const SE3 guess = SE3(Eigen::Quaterniond::Identity(), {0.15, -0.1, 0.0}) * looks.H;
  const PoseEstimate estimate =
      estimate_relative_motion(looks.problem(), guess, with_mode(SgfMode::geometry));
  ASSERT_TRUE(estimate.usable());
  EXPECT_GT(estimate.num_matches, 50U);
  EXPECT_LT(looks.position_error_m(estimate), 0.05);
  EXPECT_LT(looks.rotation_error_rad(estimate), 1.0 * kDegree);
}

TEST(SgfSolver, FusionIsBetterThanBothWithNoisyBoxesAndAFarGuess) {
  TwoLooks looks(0.01);
  looks.now.center_lidar_m += Eigen::Vector3d(0.15, 0.1, 0.0);
  looks.now.yaw_rad += 3.0 * kDegree;
  const SE3 far = SE3(Eigen::Quaterniond::Identity(), {1.5, 0.8, 0.0}) * looks.H;
  const double fusion =
      looks.position_error_m(estimate_relative_motion(looks.problem(), far, with_mode(SgfMode::fusion)));
  const double semantic =
      looks.position_error_m(estimate_relative_motion(looks.problem(), far, with_mode(SgfMode::semantic)));
  const double geometry =
      looks.position_error_m(estimate_relative_motion(looks.problem(), far, with_mode(SgfMode::geometry)));
  EXPECT_LT(fusion, semantic);
  EXPECT_LT(fusion, geometry);
}

TEST(SgfSolver, PrintedFormConvergesFromAPrediction) {
  const TwoLooks looks(0.0);
  SgfConfig printed;
  printed.centred = false;
  printed.printed_weights = true;
  printed.kernel = 0.0;
  const SE3 guess = SE3(Eigen::Quaterniond::Identity(), {0.1, -0.1, 0.0}) * looks.H;
  const PoseEstimate estimate = estimate_relative_motion(looks.problem(), guess, printed);
  ASSERT_TRUE(estimate.usable());
  EXPECT_LT(looks.position_error_m(estimate), 0.05);
}

TEST(SgfSolver, MorePointsAreSurer) {
  const TwoLooks looks(0.01);
  const auto variance = [&](SgfMode mode) {
    return estimate_relative_motion(looks.problem(), looks.H, with_mode(mode))
        .covariance.topLeftCorner<3, 3>()
        .trace();
  };
  EXPECT_GT(variance(SgfMode::fusion), 0.0);
  EXPECT_LT(variance(SgfMode::fusion), variance(SgfMode::semantic));
}

TEST(SgfSolver, NothingToEstimateFromKeepsTheGuess) {
  const SE3 guess(so3_exp({0.0, 0.0, 0.1}), {1.0, 2.0, 3.0});
  const PoseEstimate estimate = estimate_relative_motion({}, guess, {});
  EXPECT_EQ(estimate.status, EstimateStatus::too_few_matches);
  EXPECT_TRUE(estimate.T_target_source.matrix().isApprox(guess.matrix(), 1e-12));
}

TEST(SgfSolver, OnePointIsTooFewForGeometryAndNoHarmToFusion) {
  TwoLooks looks(0.0);
  looks.points.resize(1);
  EXPECT_EQ(estimate_relative_motion(looks.problem(), looks.H, with_mode(SgfMode::geometry)).status,
            EstimateStatus::too_few_matches);
  EXPECT_LT(looks.position_error_m(estimate_relative_motion(looks.problem(), SE3(), {})), 0.05);
}

TEST(SgfSolver, ABoxWithoutPointsIsSemantic) {
  TwoLooks looks(0.0);
  looks.points.clear();
  const PoseEstimate estimate = estimate_relative_motion(looks.problem(), SE3(), {});
  EXPECT_TRUE(estimate.usable());
  EXPECT_LT(looks.position_error_m(estimate), 2e-3);
}

TEST(SgfSolver, AFlatWallLeavesDirectionsOpenAndSaysSo) {
  std::vector<Eigen::Vector3d> wall;
  for (int i = 0; i < 144; ++i) wall.emplace_back(10.0, 0.12 * (i % 12), 0.12 * (i / 12));
  ShapeConfig shape;
  shape.wide_m = 1e3;
  const auto points = shaped_points(wall, shape);
  const ObjectTarget target(points, 0.3);
  const SgfProblem problem{.target = &target, .points = points, .previous_box = {}, .current_box = {}};
  const PoseEstimate estimate = estimate_relative_motion(problem, SE3(), with_mode(SgfMode::geometry));
  EXPECT_EQ(estimate.status, EstimateStatus::degenerate);
  EXPECT_GE(estimate.degenerate_directions, 3);
}

TEST(SgfSolver, AbsurdSizesStayFinite) {
  TwoLooks looks(0.0);
  looks.now.size_lwh_m = {1e6, 1e6, 1e6};
  const PoseEstimate estimate = estimate_relative_motion(looks.problem(), looks.H, {});
  EXPECT_TRUE(estimate.T_target_source.is_finite());
  EXPECT_LT(looks.position_error_m(estimate), 0.1) << "points and the robust kernel hold it";
}

}  // namespace
}  // namespace mlo
