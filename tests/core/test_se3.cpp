#include <random>

#include <gtest/gtest.h>

#include "mlo/core/se3.hpp"

namespace mlo {
namespace {

std::vector<SE3::Tangent> samples() {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<SE3::Tangent> all{SE3::Tangent::Zero()};
  for (const double scale : {1e-9, 1e-6, 1e-3, 0.5, 1.5}) {
    for (int i = 0; i < 20; ++i) {
      SE3::Tangent xi;
      for (int k = 0; k < 6; ++k) xi(k) = scale * uniform(rng) * (k < 3 ? 10.0 : 1.0);
      all.push_back(xi);
    }
  }
  return all;
}

TEST(SE3, ExpAndLogAreInverse) {
  for (const SE3::Tangent& xi : samples()) {
    EXPECT_LT((SE3::exp(xi).log() - xi).norm(), 1e-9 * (1.0 + xi.norm())) << xi.transpose();
  }
}

TEST(SE3, ExpIsTheMatrixExponential) {
  for (const SE3::Tangent& xi : samples()) {
    Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
    A.topLeftCorner<3, 3>() = skew(xi.tail<3>());
    A.topRightCorner<3, 1>() = xi.head<3>();
    Eigen::Matrix4d sum = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d term = sum;
    for (int n = 1; n < 40; ++n) sum += term = term * A / n;
    EXPECT_TRUE(SE3::exp(xi).matrix().isApprox(sum, 1e-11)) << xi.transpose();
  }
}

TEST(SE3, GroupLaws) {
  const auto xis = samples();
  const Eigen::Vector3d p(1.0, -2.0, 3.0);
  for (std::size_t i = 2; i < xis.size(); ++i) {
    const SE3 a = SE3::exp(xis[i]);
    const SE3 b = SE3::exp(xis[i - 1]);
    const SE3 c = SE3::exp(xis[i - 2]);
    EXPECT_TRUE(((a * b) * c).matrix().isApprox((a * (b * c)).matrix(), 1e-12));
    EXPECT_TRUE((a * a.inverse()).matrix().isApprox(Eigen::Matrix4d::Identity(), 1e-12));
    EXPECT_TRUE(((a * b) * p).isApprox(a * (b * p), 1e-12));
    EXPECT_TRUE(SE3::from_matrix(a.matrix()).matrix().isApprox(a.matrix(), 1e-12));
  }
}

TEST(SE3, AdjointMovesAPerturbationAcross) {
  const auto xis = samples();
  for (std::size_t i = 1; i < xis.size(); ++i) {
    const SE3 T = SE3::exp(xis[i]);
    const SE3::Tangent xi = 0.1 * xis[i - 1];
    EXPECT_TRUE((T * SE3::exp(xi)).matrix().isApprox((SE3::exp(T.adjoint() * xi) * T).matrix(), 1e-10));
  }
}

TEST(SE3, InterpolationHasConstantVelocity) {
  SE3::Tangent xi;
  xi << 1.0, 2.0, -0.5, 0.1, -0.2, 0.4;
  const SE3 T = SE3::exp(xi);
  EXPECT_TRUE(interpolate(T, 0.0).matrix().isIdentity(1e-12));
  EXPECT_TRUE(interpolate(T, 1.0).matrix().isApprox(T.matrix(), 1e-12));
  EXPECT_TRUE((interpolate(T, 0.3) * interpolate(T, 0.7)).matrix().isApprox(T.matrix(), 1e-12));
  EXPECT_TRUE(interpolate(T, -1.0).matrix().isApprox(T.inverse().matrix(), 1e-12));
}

TEST(SE3, ProductsOfManyIncrementsStayRotations) {
  SE3 T;
  SE3::Tangent xi;
  xi << 1.0, 0.0, 0.0, 0.0, 0.0, 0.01;
  for (int i = 0; i < 100000; ++i) T = T * SE3::exp(xi);
  EXPECT_NEAR(T.rotation().norm(), 1.0, 1e-12);
}

}  // namespace
}  // namespace mlo
