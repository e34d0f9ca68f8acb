#include <gmock/gmock.h>
#include <tbb/task_arena.h>

#include "mlo/odometry/consistency_check.hpp"
#include "mlo/odometry/two_step_ego.hpp"
#include "odometry/scene.hpp"

namespace mlo {
namespace {

using test::Scene;
using test::View;

// A street beside which a train passes: `share` of the posts are its edges and move by train_motion between
// scans.
struct TrainScene {
  Percept current;
  ReferenceScan previous;
  SE3 T_previous_current;
};

TrainScene train_scene(std::size_t num_moving, const Eigen::Vector2d& train_motion, std::uint64_t seed) {
  Scene scene;
  scene.walls = {{{-30.0, 12.0}, {30.0, 13.0}}, {{25.0, -8.0}, {28.0, 8.0}}};
  for (int i = 0; i < 12; ++i) scene.posts.emplace_back(-28.0 + 5.1 * i, i % 2 == 0 ? 7.0 : 9.0);
  const std::size_t num_static = scene.posts.size();
  for (std::size_t i = 0; i < num_moving; ++i)
    scene.posts.emplace_back(-25.0 + 50.0 * static_cast<double>(i) / static_cast<double>(num_moving), -6.0);
  View view{.T_world_lidar = test::pose_above_ground(0.0, 0.0, 0.0),
            .T_previous_current = SE3(so3_exp({0.0, 0.0, 0.01}), {1.0, 0.0, 0.0}),
            .motion_compensated = true,
            .noise_m = 0.01,
            .seed = seed};
  TrainScene result;
  result.T_previous_current = view.T_previous_current;
  result.previous = make_reference_scan(observe(scene, view), SweepMotion::none(), 15000);
  for (std::size_t i = num_static; i < scene.posts.size(); ++i) scene.posts[i] += train_motion;
  view.T_world_lidar = view.T_world_lidar * view.T_previous_current;
  view.seed += 1;
  result.current = observe(scene, view);
  return result;
}

EgoOdometryResult estimate(const TrainScene& scene, bool check, const SE3& guess) {
  OdometryConfig config;
  config.consistency_check = check;
  return estimate_ego(scene.current, scene.previous, guess, {.motion_compensated = true}, config, 3);
}

double error_m(const TrainScene& scene, const EgoOdometryResult& result) {
  return (scene.T_previous_current.inverse() * result.increment.T_target_source).translation().norm();
}

struct TrainCase {
  std::size_t num_moving;  ///< posts; 12 stand
  double train_m;          ///< per scan
};

// The prediction (0.5 m; the lidar moves 1 m) is nearer to what the train seems to say, as when starting off
// beside it.
TEST(ConsistencyCheck, FindsTheStaticPartBesideATrain) {
  const SE3 guess(Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0});
  for (const TrainCase& c : {TrainCase{9, 0.4}, {9, 0.6}, {12, 0.4}, {12, 0.6}, {12, 0.9}, {16, 0.9}}) {
    for (const std::uint64_t seed : {101, 103}) {
      const TrainScene scene = train_scene(c.num_moving, {c.train_m, 0.0}, seed);
      const EgoOdometryResult with = estimate(scene, true, guess);
      EXPECT_TRUE(with.consistency.passed);
      EXPECT_LT(with.consistency.num_after, with.consistency.num_before);
      EXPECT_LT(error_m(scene, with), 0.02) << c.num_moving << " posts moving by " << c.train_m;
      EXPECT_GT(error_m(scene, estimate(scene, false, guess)), 0.1);
    }
  }
}

// Where more moves than stands, features alone cannot tell which is which: the prediction decides.
TEST(ConsistencyCheck, HoldsOnToAGoodPredictionBesideALongTrain) {
  const TrainScene scene = train_scene(16, {0.6, 0.0}, 101);
  const EgoOdometryResult result =
      estimate(scene, true, SE3(Eigen::Quaterniond::Identity(), {0.9, 0.0, 0.0}));
  EXPECT_TRUE(result.consistency.passed);
  EXPECT_LT(error_m(scene, result), 0.02);
}

TEST(ConsistencyCheck, KeepsMostOfAStaticScene) {
  const TrainScene scene = train_scene(12, {0.0, 0.0}, 5);
  const EgoOdometryResult result = estimate(scene, true, scene.T_previous_current);
  EXPECT_TRUE(result.consistency.passed);
  EXPECT_GT(result.consistency.num_after, result.consistency.num_before * 95 / 100);
  EXPECT_LT(error_m(scene, result), 0.01);
}

EgoFeatures features_of(const Percept& percept) {
  return {percept.ground.features, percept.edge.features, percept.surface.features};
}

TEST(ConsistencyCheck, PassesEverythingOnWhenNoMotionHasSupport) {
  const TrainScene scene = train_scene(12, {0.5, 0.0}, 5);
  OdometryConfig config;
  config.consistency.min_share = 1.0;
  const EgoFeatures features = features_of(scene.current);
  const SE3 guess(Eigen::Quaterniond::Identity(), {0.9, 0.0, 0.0});
  const ConsistencyResult result =
      check_consistency(features, scene.previous, guess, {.motion_compensated = true}, config, 3);
  EXPECT_TRUE(result.report.run);
  EXPECT_FALSE(result.report.passed);
  EXPECT_EQ(result.features.size(), features.size());
  EXPECT_EQ(result.T_previous_current.matrix(), guess.matrix());
  EXPECT_EQ(result.report.num_tried, 1U + static_cast<std::size_t>(config.consistency.iterations));
}

TEST(ConsistencyCheck, DependsOnSeedAndFrameOnly) {
  const TrainScene scene = train_scene(12, {0.6, 0.0}, 5);
  const EgoFeatures features = features_of(scene.current);
  const SE3 guess(Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0});
  const auto motion = [&](int threads, std::uint64_t seed, std::size_t frame) {
    OdometryConfig config;
    config.consistency.seed = seed;
    tbb::task_arena arena(threads);
    return arena.execute([&] {
      return check_consistency(features, scene.previous, guess, {.motion_compensated = true}, config, frame)
          .T_previous_current.matrix();
    });
  };
  EXPECT_EQ(motion(1, 1, 3), motion(2, 1, 3));
  EXPECT_NE(motion(2, 1, 3), motion(2, 2, 3));
  EXPECT_NE(motion(2, 1, 3), motion(2, 1, 5));
}

TEST(ConsistencyCheck, HandlesNothing) {
  const ConsistencyResult result = check_consistency({}, {}, SE3(), {}, {}, 0);
  EXPECT_FALSE(result.report.passed);
  EXPECT_EQ(result.features.size(), 0U);
}

}  // namespace
}  // namespace mlo
