#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "mlo/evaluation/scan_consistency.hpp"

namespace mlo {
namespace {

using Points = std::vector<Eigen::Vector3f>;

// A wall of 10 m x 10 m at x = offset_m, as thick as the noise.
Points wall(double offset_m, double sigma_m, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> along(-5.0, 5.0);
  std::normal_distribution<double> across;
  Points points;
  for (int i = 0; i < 5000; ++i) {
    points.push_back(Eigen::Vector3d(offset_m + sigma_m * across(rng), along(rng), along(rng)).cast<float>());
  }
  return points;
}

TEST(ScanConsistency, ResidualsAreTheOffsetOfTheWalls) {
  for (const double offset_m : {0.02, 0.1}) {
    const ScanConsistency consistency = scan_consistency(wall(0.0, 1e-3, 1), wall(offset_m, 1e-3, 2));
    EXPECT_GT(consistency.residuals_m.size(), 4000U);
    EXPECT_NEAR(consistency.median_m().value(), offset_m, 2e-3);
    EXPECT_NEAR(consistency.mean_m().value(), offset_m, 2e-3);
  }
}

TEST(ScanConsistency, NoiseAloneIsItsOwnResidual) {
  const ScanConsistency consistency = scan_consistency(wall(0.0, 0.02, 1), wall(0.0, 0.02, 2));
  EXPECT_NEAR(consistency.median_m().value(), 0.6745 * 0.02, 2e-3);  // median of |N(0, sigma)|
}

TEST(ScanConsistency, FarApartEmptyAndNan) {
  EXPECT_FALSE(scan_consistency(wall(0.0, 1e-3, 1), wall(3.0, 1e-3, 2)).median_m());
  EXPECT_FALSE(scan_consistency({}, wall(0.0, 1e-3, 2)).mean_m());
  EXPECT_FALSE(scan_consistency(wall(0.0, 1e-3, 2), {}).mean_m());
  Points broken = wall(0.01, 1e-3, 2);
  broken[7].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NEAR(scan_consistency(wall(0.0, 1e-3, 1), broken).median_m().value(), 0.01, 2e-3);
}

}  // namespace
}  // namespace mlo
