#include <gtest/gtest.h>

#include "mlo/simulator/ray_world.hpp"
#include "simulator/small_scene.hpp"

namespace mlo::simulator {
namespace {

const Eigen::Vector3d kAhead = Eigen::Vector3d::UnitX();

TEST(RayWorld, MeetsAWallAtItsDistanceAndIncidence) {
  const Scene scene = small_scene();
  RayWorld world(scene);
  world.set_sweep(0.0, 0.1, {0, 0, 1}, 80.0);
  const auto hit = world.cast({0, 0, 1}, kAhead, 0.5, 80.0);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->range_m, 20.0, 1e-4);
  EXPECT_NEAR(hit->cos_incidence, 1.0, 1e-6);
  EXPECT_EQ(hit->surface, Surface::wall);
  EXPECT_EQ(hit->object_id, 0);
  const auto slanted = world.cast({0, 0, 1}, Eigen::Vector3d(1, 1, 0).normalized(), 0.5, 80.0);
  ASSERT_TRUE(slanted);
  EXPECT_NEAR(slanted->range_m, 20.0 * std::sqrt(2.0), 1e-3);
  EXPECT_NEAR(slanted->cos_incidence, std::sqrt(0.5), 1e-6);
}

TEST(RayWorld, SeesNothingBeyondTheRangeOrInTheSky) {
  const Scene scene = small_scene();
  RayWorld world(scene);
  world.set_sweep(0.0, 0.1, {0, 0, 1}, 80.0);
  EXPECT_FALSE(world.cast({0, 0, 1}, kAhead, 0.5, 19.9));
  EXPECT_FALSE(world.cast({0, 0, 1}, Eigen::Vector3d::UnitZ(), 0.5, 80.0));
}

TEST(RayWorld, EachRaySeesMoversWhereTheyAreAtItsOwnTime) {
  const Scene scene = small_scene();
  RayWorld world(scene);
  const double start = 2.0, end = 2.1;
  world.set_sweep(start, end, {0, 0, 1}, 80.0);
  for (const double fraction : {0.0, 0.13, 0.5, 0.77, 1.0}) {
    const double time = start + fraction * (end - start);
    const SE3 car = T_world_object(scene, scene.objects[0], time);
    // a ray along the car's flank, just behind its tail, and one just before it
    const double tail = car.translation().y() - 0.5 * scene.models[0].size_lwh_m.x();
    const Eigen::Vector3d from(10.0, tail - 5.0, 0.5);
    const auto hit = world.cast(from, Eigen::Vector3d::UnitY(), fraction, 80.0);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->object_id, 1);
    EXPECT_NEAR(hit->range_m, 5.0, 0.03) << "fraction " << fraction;  // the bumper is a little rounded
  }
}

TEST(RayWorld, ObjectsOutOfReachAreLeftOut) {
  const Scene scene = small_scene();
  RayWorld world(scene);
  world.set_sweep(0.0, 0.1, {-80, 80, 1}, 20.0);
  const SE3 car = T_world_object(scene, scene.objects[0], 0.05);
  const Eigen::Vector3d above = car.translation() + Eigen::Vector3d(0, 0, 10);
  const auto hit = world.cast(above, -Eigen::Vector3d::UnitZ(), 0.5, 80.0);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->surface, Surface::road);
}

TEST(RayWorld, AnEmptySceneAnswersNothing) {
  const Scene scene;
  RayWorld world(scene);
  world.set_sweep(0.0, 0.1, {0, 0, 0}, 80.0);
  EXPECT_FALSE(world.cast({0, 0, 0}, kAhead, 0.5, 80.0));
}

}  // namespace
}  // namespace mlo::simulator
