#include <random>

#include <gtest/gtest.h>

#include "mlo/core/se3.hpp"
#include "mlo/odometry/residuals.hpp"

namespace mlo {
namespace {

class RandomPoints {
 public:
  Eigen::Vector3d operator()() {
    std::uniform_real_distribution<double> uniform(-10.0, 10.0);
    return {uniform(random_), uniform(random_), uniform(random_)};
  }

 private:
  std::mt19937_64 random_{7};
};

// Central differences of residual_of(exp(xi) * p) in xi.
template <int Rows, class ResidualOf>
Eigen::Matrix<double, Rows, 6> numeric_jacobian(const Eigen::Vector3d& p, const ResidualOf& residual_of) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix<double, Rows, 6> jacobian;
  for (int i = 0; i < 6; ++i) {
    const SE3::Tangent xi = kStep * SE3::Tangent::Unit(i);
    jacobian.col(i) =
        (residual_of(SE3::exp(xi) * p).value - residual_of(SE3::exp(-xi) * p).value) / (2.0 * kStep);
  }
  return jacobian;
}

TEST(PointToLine, HasTheLengthOfEq3) {
  RandomPoints random;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p = random(), m = random(), n = random();
    const double eq3 = (p - m).cross(p - n).norm() / (m - n).norm();
    EXPECT_NEAR(point_to_line(p, line_through(m, n, 0.0).value()).value.norm(), eq3, 1e-9);
  }
}

TEST(PointToPlane, HasTheSizeOfEq4) {
  RandomPoints random;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p = random(), m = random(), n = random(), o = random();
    const Eigen::Vector3d cross = (m - n).cross(m - o);
    const double eq4 = std::abs((p - m).dot(cross)) / cross.norm();
    EXPECT_NEAR(std::abs(point_to_plane(p, plane_through(m, n, o, 0.0).value()).value(0)), eq4, 1e-9);
  }
}

TEST(Residuals, JacobiansAreThoseOfCentralDifferences) {
  RandomPoints random;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p = random(), m = random(), n = random(), o = random();
    const Line line = line_through(m, n, 0.0).value();
    const auto to_line = [&](const Eigen::Vector3d& q) { return point_to_line(q, line); };
    EXPECT_TRUE(point_to_line(p, line).jacobian.isApprox(numeric_jacobian<2>(p, to_line), 1e-6));
    const Plane plane = plane_through(m, n, o, 0.0).value();
    const auto to_plane = [&](const Eigen::Vector3d& q) { return point_to_plane(q, plane); };
    EXPECT_TRUE(point_to_plane(p, plane).jacobian.isApprox(numeric_jacobian<1>(p, to_plane), 1e-6));
  }
}

TEST(PointToLine, HasAFiniteJacobianOnTheLine) {
  const Line line = line_through({1, 0, 0}, {1, 0, 2}, 0.0).value();
  const Residual<2> residual = point_to_line({1, 0, 1}, line);
  EXPECT_NEAR(residual.value.norm(), 0.0, 1e-12);
  EXPECT_TRUE(residual.jacobian.allFinite());
}

TEST(Shapes, AreNotMadeOfDegeneratePoints) {
  const Eigen::Vector3d a(1, 2, 3), b(1, 2, 4), far_on_line(1, 2, 9), off_line(1, 2.1, 4);
  EXPECT_FALSE(line_through(a, a, 0.0));
  EXPECT_FALSE(line_through(a, b, 1.5));
  EXPECT_TRUE(line_through(a, b, 0.5));
  EXPECT_FALSE(plane_through(a, b, far_on_line, 0.0));
  EXPECT_FALSE(plane_through(a, a, b, 0.0));
  EXPECT_FALSE(plane_through(a, off_line, far_on_line, 0.2));
  EXPECT_TRUE(plane_through(a, off_line, far_on_line, 0.05));
  const Eigen::Vector3d nan = Eigen::Vector3d::Constant(NAN);
  EXPECT_FALSE(line_through(a, nan, 0.0));
  EXPECT_FALSE(plane_through(a, b, nan, 0.0));
}

}  // namespace
}  // namespace mlo
