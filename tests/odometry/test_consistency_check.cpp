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

TEST(ConsistencyCheck, RemovesOnlyLittleOfAStaticScene) {
  const TrainScene scene = train_scene(12, {0.0, 0.0}, 5);
  const EgoOdometryResult result = estimate(scene, true, scene.T_previous_current);
  EXPECT_TRUE(result.consistency.passed);
  EXPECT_GT(result.consistency.num_after, result.consistency.num_before * 95 / 100);
  EXPECT_LT(error_m(scene, result), 0.01);
}

}  // namespace
}  // namespace mlo
