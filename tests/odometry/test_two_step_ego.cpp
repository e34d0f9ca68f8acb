#include <gmock/gmock.h>
#include <tbb/task_arena.h>

#include "mlo/odometry/two_step_ego.hpp"
#include "odometry/scene.hpp"

namespace mlo {
namespace {

using test::View;

constexpr double kDegree = 0.017453292519943295;

// The current scan, what it is matched to, and the truth.
struct Pair {
  Percept current;
  ReferenceScan previous;
  SweepTiming timing;
  SE3 T_previous_current;
};

Pair look_twice(const test::Scene& scene, const SE3& T_previous_current, View view) {
  view.T_world_lidar = test::pose_above_ground(0.0, 0.0, 0.1, 0.01, -0.01);
  view.T_previous_current = T_previous_current;
  Pair pair;
  const Percept previous = observe(scene, view);
  const SweepMotion motion = view.motion_compensated
                                 ? SweepMotion::none()
                                 : SweepMotion(T_previous_current, view.reference_fraction);
  pair.previous = make_reference_scan(previous, motion, 15000);
  view.T_world_lidar = view.T_world_lidar * T_previous_current;
  view.seed += 1;
  pair.current = observe(scene, view);
  pair.timing = {view.motion_compensated, view.reference_fraction};
  pair.T_previous_current = T_previous_current;
  return pair;
}

EgoOdometryResult estimate(const Pair& pair, const std::optional<SE3>& guess,
                           const OdometryConfig& config = {}) {
  return estimate_ego(pair.current, pair.previous, guess, pair.timing, config, 5);
}

void expect_pose(const SE3& actual, const SE3& expected, double tolerance_m, double tolerance_deg) {
  const SE3 error = expected.inverse() * actual;
  EXPECT_LE(error.translation().norm(), tolerance_m);
  EXPECT_LE(error.rotation_angle_rad() / kDegree, tolerance_deg);
}

// A car's motion in a tenth of a second, turning.
SE3 drive(double forward_m, double yaw_deg) {
  return {so3_exp({0.001, 0.002, yaw_deg * kDegree}), {forward_m, 0.03, 0.01}};
}
SE3 a_bit_off(const SE3& motion) {
  return motion * SE3(so3_exp({0.002, -0.002, 0.01}), {0.2, -0.1, 0.02});
}

struct Case {
  const char* name;
  View view;
};
void PrintTo(const Case& value, std::ostream* stream) {
  *stream << value.name;
}

class NoiseFree : public testing::TestWithParam<Case> {};

TEST_P(NoiseFree, MotionIsRecovered) {
  const Pair pair = look_twice(test::street(), drive(1.2, 2.0), GetParam().view);
  for (const auto estimator : {OdometryConfig::Estimator::two_step, OdometryConfig::Estimator::joint}) {
    OdometryConfig config;
    config.estimator = estimator;
    const EgoOdometryResult result = estimate(pair, a_bit_off(pair.T_previous_current), config);
    EXPECT_EQ(result.increment.status, EstimateStatus::converged);
    EXPECT_EQ(result.increment.degenerate_directions, 0);
    EXPECT_TRUE(result.consistency.passed);
    EXPECT_FALSE(result.ground_scarce);
    expect_pose(result.increment.T_target_source, pair.T_previous_current, 2e-3, 1e-2);
  }
}

INSTANTIATE_TEST_SUITE_P(Views, NoiseFree,
                         testing::Values(Case{"compensated", {.motion_compensated = true}},
                                         Case{"middle", {.reference_fraction = 0.5}},
                                         Case{"end", {.reference_fraction = 1.0}},
                                         Case{"without_rings", {.rings = false}}),
                         [](const auto& instance) { return instance.param.name; });

TEST(EstimateEgo, FindsAFastStartWithoutAPrediction) {
  for (const double forward_m : {0.0, 1.0, 2.0}) {
    for (const double yaw_deg : {-5.0, 0.0, 5.0}) {
      const Pair pair = look_twice(test::street(), drive(forward_m, yaw_deg), {.noise_m = 0.01});
      const EgoOdometryResult result = estimate(pair, std::nullopt);
      EXPECT_TRUE(result.increment.usable());
      expect_pose(result.increment.T_target_source, pair.T_previous_current, 0.03, 0.1);
    }
  }
}

TEST(EstimateEgo, ReportsTheCorridorAsDegenerateAlongItsAxis) {
  const Pair pair = look_twice(test::corridor(), SE3(Eigen::Quaterniond::Identity(), {1.0, 0.02, 0.0}),
                               {.motion_compensated = true});
  OdometryConfig config;
  for (const auto estimator : {OdometryConfig::Estimator::two_step, OdometryConfig::Estimator::joint}) {
    config.estimator = estimator;
    const SE3 guess(Eigen::Quaterniond::Identity(), {0.8, 0.1, 0.0});
    const EgoOdometryResult result = estimate(pair, guess, config);
    EXPECT_EQ(result.increment.status, EstimateStatus::degenerate);
    EXPECT_EQ(result.increment.degenerate_directions, 1);
    // The lidar looks 0.1 rad off the axis; across it the data decides, along it the prediction.
    const SE3 yaw(so3_exp({0.0, 0.0, 0.1}), Eigen::Vector3d::Zero());
    const Eigen::Vector3d in_corridor = yaw * result.increment.T_target_source.translation();
    EXPECT_NEAR(in_corridor.y(), (yaw * pair.T_previous_current.translation()).y(), 2e-3);
    EXPECT_NEAR(in_corridor.x(), (yaw * guess.translation()).x(), 0.05);
    const auto& covariance = result.increment.covariance;
    EXPECT_GT(covariance(0, 0), 10.0 * covariance(1, 1));
  }
}

TEST(EstimateEgo, AnswersWithThePredictionWhenItCannotEstimate) {
  const SE3 guess = drive(1.0, 1.0);
  const Pair pair = look_twice(test::street(), guess, {});
  const auto expect_guess = [&](const Percept& current, const ReferenceScan& previous) {
    const EgoOdometryResult result = estimate_ego(current, previous, guess, pair.timing, {}, 5);
    EXPECT_EQ(result.increment.status, EstimateStatus::too_few_matches);
    EXPECT_FALSE(result.increment.usable());
    EXPECT_EQ(result.increment.T_target_source.matrix(), guess.matrix());
  };
  expect_guess({}, pair.previous);
  expect_guess(pair.current, {});
  Percept one;
  one.edge.features = {pair.current.edge.features.front()};
  expect_guess(one, pair.previous);
  Percept few;
  few.surface.features.assign(pair.current.surface.features.begin(),
                              pair.current.surface.features.begin() + 10);
  expect_guess(few, pair.previous);
  Percept not_a_number = pair.current;
  for (FeatureSet* set : {&not_a_number.ground, &not_a_number.edge, &not_a_number.surface}) {
    for (FeaturePoint& feature : set->features) feature.p_lidar.x() = NAN;
  }
  expect_guess(not_a_number, pair.previous);
  EXPECT_EQ(estimate_ego({}, {}, std::nullopt, {}, {}, 0).increment.T_target_source.matrix(), SE3().matrix());
}

TEST(EstimateEgo, EstimatesAllAtOnceWhereGroundIsMissing) {
  Pair pair = look_twice(test::street(), drive(1.0, 1.0), {});
  pair.current.ground = {};
  const EgoOdometryResult result = estimate(pair, a_bit_off(pair.T_previous_current));
  EXPECT_TRUE(result.ground_scarce);
  EXPECT_TRUE(result.increment.usable());
  const SE3 error = pair.T_previous_current.inverse() * result.increment.T_target_source;
  EXPECT_LE(error.translation().head<2>().norm(), 1e-2);
}

TEST(EstimateEgo, UsesOnlySurfacesFlatterThanTheGround) {
  Pair pair = look_twice(test::street(), drive(1.0, 1.0), {});
  const std::size_t all = estimate(pair, pair.T_previous_current).num_surface_matches;
  for (std::size_t i = 0; i < pair.current.surface.features.size(); i += 2)
    pair.current.surface.features[i].smoothness = 1.0F;
  const EgoOdometryResult flat = estimate(pair, pair.T_previous_current);
  EXPECT_NEAR(static_cast<double>(flat.num_surface_matches), 0.5 * static_cast<double>(all),
              0.1 * static_cast<double>(all));
  EXPECT_FALSE(flat.flat_surfaces_scarce);
  for (FeaturePoint& feature : pair.current.surface.features) feature.smoothness = 1.0F;
  const EgoOdometryResult none = estimate(pair, pair.T_previous_current);
  EXPECT_TRUE(none.flat_surfaces_scarce);
  EXPECT_EQ(none.num_surface_matches, all);
}

TEST(EstimateEgo, IsTheSameForAnyNumberOfThreads) {
  const Pair pair = look_twice(test::street(), drive(1.0, 1.0), {.noise_m = 0.02});
  const auto run = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return estimate(pair, std::nullopt); });
  };
  const EgoOdometryResult one = run(1);
  const EgoOdometryResult two = run(2);
  EXPECT_EQ(one.increment.T_target_source.matrix(), two.increment.T_target_source.matrix());
  EXPECT_EQ(one.increment.covariance, two.increment.covariance);
  EXPECT_EQ(one.consistency.num_after, two.consistency.num_after);
}

TEST(EstimateEgo, CovarianceTellsTheErrorsOfNoisyScans) {
  NormalEquations::Vector6d normalised = NormalEquations::Vector6d::Zero();
  constexpr int kRuns = 20;
  for (std::uint64_t i = 0; i < kRuns; ++i) {
    const Pair pair = look_twice(test::street(), drive(1.0, 1.0), {.noise_m = 0.02, .seed = 10 * i + 1});
    const PoseEstimate increment = estimate(pair, pair.T_previous_current).increment;
    const SE3::Tangent error = (increment.T_target_source * pair.T_previous_current.inverse()).log();
    normalised += error.cwiseAbs2().cwiseQuotient(increment.covariance.diagonal()) / kRuns;
  }
  // Matches share candidates, so that their errors are not independent: a few sigma are honest, ten are not.
  EXPECT_LT(normalised.maxCoeff(), 25.0);
  EXPECT_GT(normalised.minCoeff(), 0.04);
}

}  // namespace
}  // namespace mlo
