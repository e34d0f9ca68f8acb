#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "mlo/detection/box_fit.hpp"

namespace mlo {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Two sides of a rectangle, its corner at `corner`.
std::vector<Eigen::Vector2f> l_shape(const Eigen::Vector2d& corner, double yaw_rad, double length_m,
                                     double width_m) {
  std::mt19937 rng(1);
  std::normal_distribution<double> noise(0.0, 0.02);
  const Eigen::Vector2d along(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  std::vector<Eigen::Vector2f> points;
  for (double x = 0.0; x <= length_m; x += 0.1)
    points.emplace_back((corner + x * along + noise(rng) * across).cast<float>());
  for (double y = 0.0; y <= width_m; y += 0.1)
    points.emplace_back((corner + y * across + noise(rng) * along).cast<float>());
  return points;
}

TEST(FitRectangle, FindsTheHeadingOfLShapes) {
  for (double yaw_deg = 0.0; yaw_deg < 90.0; yaw_deg += 11.0) {
    const auto points = l_shape({20.0, -35.0}, yaw_deg * kRadPerDeg, 4.2, 1.8);
    const FittedRectangle fitted = fit_rectangle(points);
    EXPECT_NEAR(std::remainder(fitted.yaw_rad - yaw_deg * kRadPerDeg, std::numbers::pi / 2), 0.0,
                2.1 * kRadPerDeg);
    EXPECT_GE(fitted.yaw_rad, 0.0);
    EXPECT_LT(fitted.yaw_rad, std::numbers::pi / 2);
    EXPECT_NEAR(fitted.extent_m().maxCoeff(), 4.2, 0.2);
    EXPECT_NEAR(fitted.extent_m().minCoeff(), 1.8, 0.2);
    EXPECT_LT(fitted.mean_distance_m, 0.08);
  }
}

TEST(FitRectangle, HoldsAllPoints) {
  const auto points = l_shape({-5.0, 7.0}, 0.6, 3.0, 1.5);
  const FittedRectangle fitted = fit_rectangle(points);
  const double c = std::cos(fitted.yaw_rad);
  const double s = std::sin(fitted.yaw_rad);
  for (const Eigen::Vector2f& p : points) {
    const Eigen::Vector2d q = p.cast<double>();
    EXPECT_GT(c * q.x() + s * q.y(), fitted.min_m.x() - 1e-3);
    EXPECT_LT(c * q.x() + s * q.y(), fitted.max_m.x() + 1e-3);
    EXPECT_GT(c * q.y() - s * q.x(), fitted.min_m.y() - 1e-3);
    EXPECT_LT(c * q.y() - s * q.x(), fitted.max_m.y() + 1e-3);
  }
}

TEST(FitRectangle, OfOnePoint) {
  const std::vector<Eigen::Vector2f> point{{3.0F, 4.0F}};
  const FittedRectangle fitted = fit_rectangle(point);
  EXPECT_NEAR(fitted.extent_m().norm(), 0.0, 1e-6);
}

}  // namespace
}  // namespace mlo
