#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mlo/mapping/refinement.hpp"
#include "odometry/scene.hpp"

namespace mlo {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Points exactly on a hall's floor and walls, 40 m x 30 m and 8 m high, no nearer than a margin to where two
/// of them meet: the neighbours of a point near a corner are no plane, and where they were sampled shifts the
/// match.
class Hall {
 public:
  explicit Hall(std::uint32_t seed) : random_(seed) {}

  std::vector<Eigen::Vector3d> sample(std::size_t per_face, double margin_m) {
    const double x = 20.0 - margin_m;
    const double y = 15.0 - margin_m;
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < per_face; ++i) {
      points.emplace_back(uniform(-x, x), uniform(-y, y), 0.0);
      points.emplace_back(uniform(-x, x), 15.0, uniform(margin_m, 8));
      points.emplace_back(uniform(-x, x), -15.0, uniform(margin_m, 8));
      points.emplace_back(20.0, uniform(-y, y), uniform(margin_m, 8));
      points.emplace_back(-20.0, uniform(-y, y), uniform(margin_m, 8));
    }
    return points;
  }

 private:
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random_); }
  std::mt19937 random_;
};

std::vector<Eigen::Vector3d> map_points() {
  return Hall(1).sample(20000, 0.0);
}
std::vector<Eigen::Vector3d> scan_points() {
  return Hall(2).sample(400, 1.5);
}

LocalMap map_of(const std::vector<Eigen::Vector3d>& points_world) {
  LocalMap map({});
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : points_world) points.push_back(p.cast<float>());
  map.insert(points);
  return map;
}

/// World points as a lidar at a pose measures them: at a time that goes with the azimuth, in a sweep that
/// moves as the guess's timing and this increment say.
std::vector<FeaturePoint> measure(const std::vector<Eigen::Vector3d>& points_world, const SE3& T_world_lidar,
                                  const SE3& T_previous_current, const SweepTiming& timing) {
  const SweepMotion motion = SweepMotion::from_increment(T_previous_current, timing);
  std::vector<FeaturePoint> points;
  for (const Eigen::Vector3d& p_world : points_world) {
    FeaturePoint point;
    Eigen::Vector3d p;
    for (int i = 0; i < 20; ++i) {
      p = (T_world_lidar * motion.T_reference_at(static_cast<double>(point.sweep_fraction))).inverse() *
          p_world;
      point.sweep_fraction = static_cast<float>(0.5 * (1.0 - std::atan2(p.y(), p.x()) / std::numbers::pi));
    }
    point.p_lidar = p.cast<float>();
    points.push_back(point);
  }
  return points;
}

SE3 offset(double x, double y, double z, double roll_deg, double pitch_deg, double yaw_deg) {
  return {so3_exp(Eigen::Vector3d(roll_deg, pitch_deg, yaw_deg) * kRadPerDeg), {x, y, z}};
}

double angle_deg(const SE3& motion) {
  return motion.rotation_angle_rad() / kRadPerDeg;
}

/// A registration in the hall with known answer.
struct Case {
  SweepTiming timing;
  SE3 T_world_previous = offset(1.0, -2.0, 1.7, 0.5, -0.4, 20.0);
  SE3 T_previous_current = offset(1.1, 0.05, -0.02, 0.2, 0.1, 2.0);
  SE3 error_of_guess = offset(0.15, -0.1, 0.05, 0.3, -0.2, 0.5);
  bool motion_known = true;
};

PoseEstimate refine_in_hall(const Case& given, const RefinementConfig& config = {}) {
  const LocalMap map = map_of(map_points());
  const std::vector<FeaturePoint> points =
      measure(scan_points(), given.T_world_previous * given.T_previous_current, given.T_previous_current,
              given.timing);
  const std::vector<RefinementTerm> terms{{points, &map, ExpectedShape::plane}};
  const RefinementGuess guess{given.T_world_previous, given.T_previous_current * given.error_of_guess,
                              given.motion_known, given.timing};
  return refine(terms, guess, config);
}

void expect_recovered(const Case& given) {
  RefinementConfig config;
  config.max_iterations = 40;  // far from the answer the distortion changes with the pose: more steps
  const PoseEstimate estimate = refine_in_hall(given, config);
  EXPECT_EQ(estimate.status, EstimateStatus::converged);
  const SE3 error = (given.T_world_previous * given.T_previous_current).inverse() * estimate.T_target_source;
  EXPECT_LT(error.translation().norm(), 0.001);
  EXPECT_LT(angle_deg(error), 0.01);
  EXPECT_EQ(estimate.degenerate_directions, 0);
  EXPECT_GT(estimate.num_matches, 1000U);
}

TEST(Refine, RecoversAKnownMotionFromCompensatedScans) {
  expect_recovered({.timing = {.motion_compensated = true}});
}

TEST(Refine, RecoversAKnownMotionFromDistortedScans) {
  expect_recovered({.timing = {.reference_fraction = 0.5}});
  expect_recovered({.timing = {.reference_fraction = 1.0}});
  expect_recovered({.timing = {.reference_fraction = 0.5, .sweeps_since_previous = 2.0}});
}

TEST(Refine, SearchesWideWhileTheMotionIsUnknown) {
  expect_recovered({.timing = {.reference_fraction = 0.5},
                    .T_previous_current = offset(1.3, 0.1, 0.0, 0.0, 0.0, 1.5),
                    .error_of_guess = offset(-1.3, -0.1, 0.0, 0.0, 0.0, -1.5),
                    .motion_known = false});
}

TEST(Refine, StaysAtAnExactGuess) {
  Case given{.timing = {.motion_compensated = true}};
  given.error_of_guess = SE3();
  const PoseEstimate estimate = refine_in_hall(given);
  const SE3 moved = (given.T_world_previous * given.T_previous_current).inverse() * estimate.T_target_source;
  EXPECT_LT(moved.translation().norm(), 3e-4);
  EXPECT_LT(estimate.rms_residual_m, 0.002);
}

TEST(Refine, CovarianceIsSymmetricAndPositive) {
  for (const int max_iterations : {1, 15}) {
    RefinementConfig config;
    config.max_iterations = max_iterations;
    const PoseEstimate estimate = refine_in_hall({}, config);
    ASSERT_TRUE(estimate.covariance.allFinite());
    EXPECT_LT((estimate.covariance - estimate.covariance.transpose()).norm(),
              1e-9 * estimate.covariance.norm());
    const Eigen::SelfAdjointEigenSolver<NormalEquations::Matrix6d> eigen(estimate.covariance);
    EXPECT_GT(eigen.eigenvalues()(0), 0.0);
    EXPECT_GT(estimate.num_matches, 0U);
  }
}

TEST(Refine, ACorridorIsDegenerateAlongItsAxisAndKeepsThePrediction) {
  std::vector<Eigen::Vector3d> points_world;
  for (const Eigen::Vector3d& p : map_points()) {
    if (std::abs(p.x()) < 19.9) points_world.push_back(p);
  }
  const LocalMap map = map_of(points_world);
  std::vector<Eigen::Vector3d> seen;
  for (const Eigen::Vector3d& p : scan_points()) {
    if (std::abs(p.x()) < 15.0) seen.push_back(p);
  }
  const SE3 truth = offset(0.0, 0.5, 1.7, 0.0, 0.0, 0.0);
  const SweepTiming timing{.motion_compensated = true};
  const std::vector<FeaturePoint> points = measure(seen, truth, SE3(), timing);
  const std::vector<RefinementTerm> terms{{points, &map, ExpectedShape::plane}};
  const PoseEstimate estimate = refine(
      terms, {offset(0.0, 0.5, 1.7, 0.0, 0.0, 0.0), offset(0.2, 0.1, -0.05, 0.0, 0.0, 0.4), true, timing},
      {});
  EXPECT_EQ(estimate.status, EstimateStatus::degenerate);
  EXPECT_EQ(estimate.degenerate_directions, 1);
  EXPECT_NEAR(estimate.T_target_source.translation().x(), 0.2, 0.01);
  EXPECT_NEAR(estimate.T_target_source.translation().y(), 0.5, 0.002);
  EXPECT_NEAR(estimate.T_target_source.translation().z(), 1.7, 0.002);
  EXPECT_LT(angle_deg(estimate.T_target_source), 0.02);
  EXPECT_TRUE(estimate.covariance.allFinite());
  EXPECT_GT(estimate.covariance(0, 0), 100.0 * estimate.covariance(1, 1));
}

TEST(Refine, WithoutEnoughPointsTheGuessComesBackFlagged) {
  const LocalMap map = map_of(map_points());
  const LocalMap empty{LocalMapConfig{}};
  const SE3 T_world_previous = offset(1.0, 2.0, 1.7, 0.0, 0.0, 30.0);
  const SE3 T_previous_current = offset(1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  const auto points = measure(scan_points(), T_world_previous * T_previous_current, SE3(), {});
  const std::span<const FeaturePoint> all(points);
  const auto status_of = [&](std::span<const FeaturePoint> some, const LocalMap& target) {
    const std::vector<RefinementTerm> terms{{some, &target, ExpectedShape::plane}};
    const PoseEstimate estimate = refine(terms, {T_world_previous, T_previous_current, true, {}}, {});
    EXPECT_EQ(estimate.T_target_source.matrix(), (T_world_previous * T_previous_current).matrix());
    EXPECT_FALSE(estimate.usable());
    return estimate.status;
  };
  EXPECT_EQ(status_of({}, map), EstimateStatus::too_few_matches);
  EXPECT_EQ(status_of(all.first(5), map), EstimateStatus::too_few_matches);
  EXPECT_EQ(status_of(all, empty), EstimateStatus::too_few_matches);
  EXPECT_EQ(refine({}, {T_world_previous, T_previous_current, true, {}}, {}).status,
            EstimateStatus::too_few_matches);
}

TEST(Refine, EdgesAndPlanesInMapsOfTheirOwn) {
  const test::Scene scene = test::street();
  const SE3 T_world_previous = test::pose_above_ground(0.0, 0.0, 0.0);
  const SE3 T_previous_current = offset(0.8, 0.05, 0.0, 0.0, 0.0, 1.5);
  std::vector<Eigen::Vector3d> flat;
  std::vector<Eigen::Vector3d> posts;
  const test::View view{.T_world_lidar = T_world_previous, .motion_compensated = true};
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    test::View other = view;
    other.seed = seed;
    const Percept seen = test::observe(scene, other);
    for (const auto* set : {&seen.ground, &seen.surface}) {
      for (const FeaturePoint& p : set->candidates)
        flat.push_back(T_world_previous * p.p_lidar.cast<double>());
    }
    for (const FeaturePoint& p : seen.edge.candidates) {
      posts.push_back(T_world_previous * p.p_lidar.cast<double>());
    }
  }
  const LocalMap flat_map = map_of(flat);
  const LocalMap post_map = map_of(posts);
  test::View now{.T_world_lidar = T_world_previous * T_previous_current, .motion_compensated = true};
  now.seed = 99;
  const Percept seen = test::observe(scene, now);
  const std::vector<RefinementTerm> terms{{seen.ground.candidates, &flat_map, ExpectedShape::plane},
                                          {seen.edge.candidates, &post_map, ExpectedShape::line},
                                          {seen.surface.candidates, &flat_map, ExpectedShape::plane}};
  RefinementConfig config;
  config.shape_model = ShapeModel::loam;
  const SweepTiming timing{.motion_compensated = true};
  const PoseEstimate estimate = refine(
      terms, {T_world_previous, T_previous_current * offset(0.1, -0.1, 0.0, 0.0, 0.0, 0.3), true, timing},
      config);
  const SE3 error = now.T_world_lidar.inverse() * estimate.T_target_source;
  EXPECT_TRUE(estimate.usable());
  EXPECT_LT(error.translation().norm(), 0.005);
  EXPECT_LT(angle_deg(error), 0.02);
}

TEST(Refine, OneAndTwoThreadsGiveTheSameBits) {
  const Case given{.timing = {.reference_fraction = 0.5}};
  std::vector<PoseEstimate> results;
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(refine_in_hall(given));
  }
  EXPECT_EQ(results[0].T_target_source.matrix(), results[1].T_target_source.matrix());
  EXPECT_EQ(results[0].covariance, results[1].covariance);
  EXPECT_EQ(results[0].num_matches, results[1].num_matches);
  EXPECT_EQ(results[0].iterations, results[1].iterations);
}

}  // namespace
}  // namespace mlo
