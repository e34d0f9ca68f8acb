#include <gtest/gtest.h>

#include "mlo/tracking/sgf_residuals.hpp"
#include "tracking/boxes.hpp"

namespace mlo {
namespace {

const SE3 kH(so3_exp({0.02, -0.03, 0.08}), {-0.9, 0.2, 0.05});

/// Central differences of a vector residual over perturbations exp(xi) * H.
template <class Residual>
Matrix36 numeric_jacobian(const Residual& residual, const SE3& H) {
  constexpr double kStep = 1e-6;
  Matrix36 J;
  for (Eigen::Index i = 0; i < 6; ++i) {
    SE3::Tangent xi = SE3::Tangent::Zero();
    xi(i) = kStep;
    J.col(i) = (residual(SE3::exp(xi) * H) - residual(SE3::exp(-xi) * H)) / (2.0 * kStep);
  }
  return J;
}

TEST(SgfResiduals, PlanesOfABoxTouchItsFaces) {
  const Box3d box{{10.0, -4.0, 1.0}, {4.0, 2.0, 1.5}, 0.7};
  const SE3 L = box.T_lidar_object();
  const auto planes = planes_of(box);
  const Eigen::Vector3d faces[6] = {{2.0, 0.0, 0.0},  {-2.0, 0.0, 0.0}, {0.0, 1.0, 0.0},
                                    {0.0, -1.0, 0.0}, {0.0, 0.0, 0.75}, {0.0, 0.0, -0.75}};
  for (std::size_t i = 0; i < planes.size(); ++i) {
    EXPECT_NEAR(planes[i].normal.dot(L * faces[i]) + planes[i].d_m, 0.0, 1e-12) << i;
    EXPECT_LT(planes[i].normal.dot(box.center_lidar_m) + planes[i].d_m, 0.0) << "normals point outwards";
  }
}

TEST(SgfResiduals, MovedPlanesFitAtTheTrueMotion) {
  const Box3d now{{15.0, 3.0, -1.0}, {4.0, 1.7, 1.5}, 0.3};
  const SE3 H(so3_exp({0.0, 0.0, 0.05}), {-1.0, 0.3, 0.0});
  const Box3d before{H * now.center_lidar_m, now.size_lwh_m, now.yaw_rad + 0.05};
  const auto a = planes_of(before);
  const auto b = planes_of(now);
  for (const Eigen::Vector3d& origin : {Eigen::Vector3d(0.0, 0.0, 0.0), before.center_lidar_m}) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_LT(plane_residual(a[i], b[i], H, origin).value.norm(), 1e-12);
    }
  }
}

TEST(SgfResiduals, PlaneJacobianAgreesWithDifferences) {
  const auto before = planes_of({{15.0, 3.0, -1.0}, {4.0, 1.7, 1.5}, 0.3});
  const auto now = planes_of({{16.0, 2.5, -1.1}, {4.2, 1.6, 1.4}, 0.4});
  for (const Eigen::Vector3d& origin : {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(15.0, 3.0, -1.0)}) {
    for (std::size_t i = 0; i < now.size(); ++i) {
      const auto residual = [&](const SE3& H) { return plane_residual(before[i], now[i], H, origin).value; };
      const Matrix36 numeric = numeric_jacobian(residual, kH);
      const Matrix36 analytic = plane_residual(before[i], now[i], kH, origin).jacobian;
      EXPECT_LT((analytic - numeric).norm(), 1e-6 * std::max(1.0, numeric.norm())) << "face " << i;
    }
  }
}

TEST(SgfResiduals, AboutTheLidarAYawErrorGrowsWithRangeAboutTheBoxItDoesNot) {
  const auto error = [](double range_m, bool centred) {
    const Box3d box{{range_m, 0.0, 0.0}, {4.0, 1.7, 1.5}, 0.5};
    Box3d turned = box;
    turned.yaw_rad += 0.02;
    const Eigen::Vector3d origin = centred ? box.center_lidar_m : Eigen::Vector3d(0.0, 0.0, 0.0);
    return plane_residual(planes_of(box)[0], planes_of(turned)[0], SE3(), origin).value.norm();
  };
  EXPECT_GT(error(60.0, false), 2.5 * error(20.0, false));
  EXPECT_NEAR(error(60.0, true), error(20.0, true), 1e-9);
}

TEST(SgfResiduals, PointJacobianAgreesWithDifferences) {
  const Eigen::Vector3d mean(14.0, 2.0, -0.5);
  for (const double share : {1.0, 0.5, 1.4}) {
    const ShapedPoint point{.p_lidar = {15.0, 2.2, -0.6}, .share = share};
    const auto residual = [&](const SE3& H) { return point_residual(point, mean, RelativeMotion(H)).value; };
    const Matrix36 numeric = numeric_jacobian(residual, kH);
    const Matrix36 analytic = point_residual(point, mean, RelativeMotion(kH)).jacobian;
    // Between the reference times the derivative is of second order in the motion.
    EXPECT_LT((analytic - numeric).norm(), (share == 1.0 ? 1e-6 : 1e-3) * numeric.norm())
        << "share " << share;
  }
}

TEST(SgfResiduals, SharesAreInterpolatedOnTheManifold) {
  const ShapedPoint point{.p_lidar = {15.0, 2.2, -0.6}, .share = 0.3};
  const Eigen::Vector3d expected = interpolate(kH, 0.3) * point.p_lidar;
  EXPECT_LT((RelativeMotion(kH).move(point) - expected).norm(), 1e-12);
}

TEST(SgfResiduals, CovariancesAddUp) {
  ObjectTarget::Voxel voxel;
  voxel.covariance = Eigen::Vector3d(1.0, 2.0, 3.0).asDiagonal();
  ShapedPoint point;
  point.covariance = Eigen::Vector3d(4.0, 5.0, 6.0).asDiagonal();
  const SE3 quarter(so3_exp({0.0, 0.0, 90.0 * test::kDegree}), {1.0, 2.0, 3.0});
  const Eigen::Matrix3d sum = point_covariance(point, voxel, quarter);
  EXPECT_TRUE(sum.isApprox(Eigen::Matrix3d(Eigen::Vector3d(6.0, 6.0, 9.0).asDiagonal()), 1e-12));
}

TEST(SgfResiduals, ShapesFollowTheSurface) {
  std::vector<Eigen::Vector3d> wall;
  for (int i = 0; i < 100; ++i) wall.emplace_back(5.0, 0.1 * (i % 10), 0.1 * (i / 10));
  const ShapeConfig config;
  const auto shaped = shaped_points(wall, config);
  ASSERT_EQ(shaped.size(), wall.size());
  for (const ShapedPoint& point : shaped) {
    EXPECT_NEAR(point.covariance(0, 0), config.thick_m * config.thick_m, 1e-9);
    EXPECT_NEAR(point.covariance(1, 1), config.wide_m * config.wide_m, 1e-9);
  }
}

TEST(SgfResiduals, FewPointsHaveNoShape) {
  EXPECT_TRUE(shaped_points({}, {}).empty());
  const std::vector<Eigen::Vector3d> one{{1.0, 2.0, 3.0}};
  const double wide = ShapeConfig{}.wide_m;
  EXPECT_TRUE(
      shaped_points(one, {})[0].covariance.isApprox(wide * wide * Eigen::Matrix3d::Identity(), 1e-12));
  const std::vector<Eigen::Vector3d> broken{{std::nan(""), 0.0, 0.0}, {1.0, 2.0, 3.0}};
  EXPECT_EQ(shaped_points(broken, {}).size(), 1U);
}

TEST(SgfResiduals, ManyPointsAreThinned) {
  std::vector<Eigen::Vector3d> cube;
  for (int i = 0; i < 8000; ++i) cube.emplace_back(0.1 * (i % 20), 0.1 * (i / 20 % 20), 0.1 * (i / 400));
  EXPECT_EQ(shaped_points(cube, {}).size(), ShapeConfig{}.max_points);
}

TEST(ObjectTarget, FindsItsOwnVoxelThenANeighbour) {
  const std::vector<ShapedPoint> points{{.p_lidar = {0.1, 0.1, 0.1}}, {.p_lidar = {0.2, 0.2, 0.2}}};
  const ObjectTarget target(points, 0.3);
  ASSERT_NE(target.find({0.05, 0.05, 0.05}), nullptr);
  EXPECT_EQ(target.find({0.05, 0.05, 0.05})->count, 2);
  EXPECT_TRUE(target.find({0.05, 0.05, 0.05})->mean.isApprox(Eigen::Vector3d(0.15, 0.15, 0.15), 1e-12));
  EXPECT_NE(target.find({0.4, 0.1, 0.1}), nullptr);
  EXPECT_EQ(target.find({0.7, 0.1, 0.1}), nullptr);
  EXPECT_TRUE(ObjectTarget().empty());
}

}  // namespace
}  // namespace mlo
