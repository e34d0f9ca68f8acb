#include <cmath>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/simulator/ground_truth.hpp"
#include "mlo/simulator/lidar_model.hpp"
#include "mlo/simulator/site.hpp"

namespace mlo::simulator {
namespace {

constexpr double kSweep_s = 0.1;

SensorConfig coarse_sensor() {
  SensorConfig sensor = hdl64e();
  sensor.columns = 720;
  return sensor;
}

class EveryScene : public testing::TestWithParam<SceneKind> {
 protected:
  static Scene scene(std::uint64_t seed = 5) {
    return make_scene(
        {.kind = GetParam(), .length_m = GetParam() == SceneKind::jam ? 15.0 : 120.0, .seed = seed});
  }
};

TEST_P(EveryScene, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const auto signature = [](const Scene& scene) {
    double sum = scene.duration_s;
    for (const Mesh& mesh : scene.meshes) {
      for (const Eigen::Vector3f& vertex : mesh.vertices)
        sum += vertex.cast<double>().dot(Eigen::Vector3d(1, 2, 3));
    }
    for (const SceneObject& object : scene.objects)
      sum += T_world_object(scene, object, 1.0).translation().x();
    return sum;
  };
  EXPECT_EQ(signature(scene(5)), signature(scene(5)));
  EXPECT_NE(signature(scene(5)), signature(scene(6)));
}

TEST_P(EveryScene, RobotDrivesTheWayAskedForSmoothly) {
  const Scene built = scene();
  const Motion& robot = built.robot.planar;
  const double length = GetParam() == SceneKind::jam ? 15.0 : 120.0;
  EXPECT_NEAR(robot.at(built.duration_s).travelled_m, length, 2.0);
  for (double t = kSweep_s; t + kSweep_s < built.duration_s; t += kSweep_s) {
    const double change = robot.at(t + kSweep_s).speed_mps - robot.at(t).speed_mps;
    EXPECT_LT(std::abs(change), 6.5 * kSweep_s) << "at " << t;
  }
}

TEST_P(EveryScene, NothingRunsIntoAnythingElse) {
  const Scene built = scene();
  const auto footprint = [&](const SceneObject& object, double time_s) {
    const PlanarState state = object.motion.at(time_s);
    const Eigen::Vector3d& size = built.models[object.model].size_lwh_m;
    return Footprint{state.p_world, state.yaw_rad, size.x(), size.y()};
  };
  for (double t = 0.0; t < built.duration_s; t += 1.0) {
    const PlanarState robot = built.robot.planar.at(t);
    for (std::size_t i = 0; i < built.objects.size(); ++i) {
      const Footprint one = footprint(built.objects[i], t);
      EXPECT_FALSE(overlap(one, {robot.p_world, robot.yaw_rad, 4.5, 1.8}))
          << "robot and " << built.objects[i].id;
      for (std::size_t j = i + 1; j < built.objects.size(); ++j) {
        EXPECT_FALSE(overlap(one, footprint(built.objects[j], t), -0.1))
            << built.objects[i].id << " and " << built.objects[j].id << " at " << t;
      }
    }
  }
}

TEST_P(EveryScene, ScansHoldPlausiblyManyPointsGroundAndObjects) {
  const Scene built = scene();
  RayWorld world(built);
  const SensorConfig sensor = coarse_sensor();
  const double rays = 64.0 * sensor.columns;
  std::size_t on_objects = 0;
  for (const double part : {0.1, 0.5, 0.9}) {
    const Sweep sweep = scan(built, world, sensor, {}, part * built.duration_s, 0, 1);
    const auto points = static_cast<double>(sweep.points.size());
    EXPECT_GT(points, 0.5 * rays);
    EXPECT_LT(points, 0.95 * rays);
    double ground = 0.0;
    for (const SimulatedPoint& point : sweep.points) {
      const bool flat = point.surface == Surface::road || point.surface == Surface::grass ||
                        point.surface == Surface::sidewalk;
      ground += flat ? 1.0 : 0.0;
      on_objects += point.object_id > 0 ? 1U : 0U;
    }
    EXPECT_GT(ground / points, 0.15);
    EXPECT_LT(ground / points, 0.95);
  }
  EXPECT_GT(on_objects, 100U);
}

TEST_P(EveryScene, EveryObjectsPointsLieInItsBox) {
  const Scene built = scene();
  RayWorld world(built);
  LidarErrors errors;
  errors.range_noise_m = 0.0;
  const double start = 0.4 * built.duration_s;
  const Sweep sweep = scan(built, world, coarse_sensor(), errors, start, 0, 1);
  std::map<int, const SceneObject*> by_id;
  for (const SceneObject& object : built.objects) by_id[object.id] = &object;
  for (const SimulatedPoint& point : sweep.points) {
    if (point.object_id == 0) continue;
    const SceneObject& object = *by_id.at(point.object_id);
    const double time = start + kSweep_s * point.measured.sweep_fraction;
    const Eigen::Vector3d p_object =
        T_world_object(built, object, time).inverse() * point.p_world.cast<double>();
    const Eigen::Vector3d half = 0.5 * built.models[object.model].size_lwh_m;
    constexpr double kTolerance_m = 0.005;
    EXPECT_TRUE((p_object.cwiseAbs().array() <= half.array() + kTolerance_m).all())
        << "object " << object.id << ": " << p_object.transpose() << " in " << half.transpose();
  }
}

TEST_P(EveryScene, TruthAgreesWithTheMotionOfObjects) {
  const Scene built = scene();
  RayWorld world(built);
  const Sweep sweep = scan(built, world, coarse_sensor(), {}, 0.3 * built.duration_s, 0, 1);
  const SE3 T_world_lidar = built.robot.T_world_lidar(built.terrain, sweep.stamp_s);
  const std::vector<ObjectTruth> objects = objects_at(built, world, sweep, 110.0);
  ASSERT_FALSE(objects.empty());
  std::set<int> seen;
  for (const ObjectTruth& object : objects) {
    EXPECT_TRUE(seen.insert(object.id).second);
    EXPECT_EQ(object.moving, object.velocity_world_mps.norm() > 0.045)
        << object.id << " " << object.velocity_world_mps.norm();
    EXPECT_NEAR(
        (T_world_lidar * object.box_lidar.center_lidar_m - object.T_world_object.translation()).norm(), 0.0,
        1e-9);
    EXPECT_GE(object.visible_share, 0.0);
    EXPECT_LE(object.visible_share, 1.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryScene,
                         testing::Values(SceneKind::city, SceneKind::suburb, SceneKind::highway,
                                         SceneKind::tunnel, SceneKind::train, SceneKind::jam,
                                         SceneKind::parking),
                         [](const auto& kind) { return std::string(name_of(kind.param)); });

TEST(Scenes, SuburbReturnsToItsStart) {
  const Scene scene = make_scene({SceneKind::suburb, 320.0, 2});
  const Eigen::Vector2d start = scene.robot.planar.at(0.0).p_world;
  EXPECT_NEAR((scene.robot.planar.at(scene.duration_s).p_world - start).norm(), 0.0, 2.5);
  double highest = -1e9, lowest = 1e9;
  for (double t = 0.0; t < scene.duration_s; t += 0.5) {
    const double z = scene.robot.T_world_lidar(scene.terrain, t).translation().z();
    highest = std::max(highest, z);
    lowest = std::min(lowest, z);
  }
  EXPECT_GT(highest - lowest, 1.0);  // slopes
}

TEST(Scenes, JamCreepsStopsAndStarts) {
  const Scene scene = make_scene({SceneKind::jam, 40.0, 3});
  int stops_and_starts = 0;
  for (const SceneObject& object : scene.objects) {
    bool stood = false, crept = false;
    for (double t = 0.0; t < scene.duration_s; t += 0.5) {
      const double speed = std::abs(object.motion.at(t).speed_mps);
      stood = stood || speed < 0.02;
      crept = crept || (speed > 0.2 && speed < 2.2);
    }
    stops_and_starts += stood && crept && scene.models[object.model].object_class == ObjectClass::car ? 1 : 0;
  }
  EXPECT_GE(stops_and_starts, 15);
  for (double t = 0.0; t < scene.duration_s; t += 0.5) EXPECT_LT(scene.robot.planar.at(t).speed_mps, 2.3);
}

TEST(Scenes, ParkingHasManyAtRestAndSomeThatLeave) {
  const Scene scene = make_scene({SceneKind::parking, 150.0, 4});
  int at_rest = 0, leaving = 0;
  for (const SceneObject& object : scene.objects) {
    if (scene.models[object.model].object_class != ObjectClass::car) continue;
    const double way = object.motion.at(scene.duration_s).travelled_m;
    at_rest += way == 0.0 ? 1 : 0;
    leaving += way > 5.0 ? 1 : 0;
  }
  EXPECT_GT(at_rest, 60);
  EXPECT_GE(leaving, 2);
}

TEST(Scenes, TrainFillsTheViewOfTheDrivingAndOfTheWaitingRobotAndNoDetectorKnowsIt) {
  const Scene scene = make_scene({SceneKind::train, 200.0, 4});
  std::set<int> train;
  for (const SceneObject& object : scene.objects) {
    if (scene.models[object.model].object_class != ObjectClass::other) continue;
    train.insert(object.id);
    EXPECT_FALSE(object.detectable);
  }
  EXPECT_EQ(train.size(), 12U);
  RayWorld world(scene);
  constexpr double kDriving_s = 8.0;
  constexpr double kWaiting_s = 17.0;
  EXPECT_GT(scene.robot.planar.at(kDriving_s).speed_mps, 3.0);
  EXPECT_LT(scene.robot.planar.at(kWaiting_s).speed_mps, 0.01);
  for (const double time_s : {kDriving_s, kWaiting_s}) {
    const Sweep sweep = scan(scene, world, coarse_sensor(), {}, time_s, 0, 1);
    double on_train = 0.0;
    double above_ground = 0.0;
    for (const SimulatedPoint& point : sweep.points) {
      const bool flat = point.surface == Surface::road || point.surface == Surface::grass;
      above_ground += flat ? 0.0 : 1.0;
      on_train += train.contains(point.object_id) ? 1.0 : 0.0;
    }
    EXPECT_GT(on_train, 0.25 * above_ground) << "at " << time_s;
  }
}

TEST(Scenes, TunnelLooksTheSameFurtherOn) {
  const Scene scene = make_scene({SceneKind::tunnel, 500.0, 4});
  RayWorld world(scene);
  const double middle = 0.55 * scene.duration_s;
  world.set_sweep(middle, middle + 0.1, {0, 0, 0}, 0.0);  // without vehicles
  const PlanarState state = scene.robot.planar.at(middle);
  const Eigen::Vector3d ahead(std::cos(state.yaw_rad), std::sin(state.yaw_rad), 0.0);
  const Eigen::Vector3d place(state.p_world.x(), state.p_world.y(), 1.73);
  for (int i = 0; i < 30; ++i) {  // 20 to 160 degrees to the left and to the right
    const double degrees = (i < 15 ? 20.0 : 200.0) + 10.0 * (i % 15);
    const double angle = state.yaw_rad + degrees * M_PI / 180.0;
    const Eigen::Vector3d beam = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.02).normalized();
    const auto here = world.cast(place, beam, 0.5, 60.0);
    const auto there = world.cast(place + 7.3 * ahead, beam, 0.5, 60.0);
    ASSERT_TRUE(here && there) << i;
    EXPECT_NEAR(here->range_m, there->range_m, 0.01);
  }
}

TEST(Scenes, LengthsThatCannotBeAreRefused) {
  EXPECT_THROW(make_scene({SceneKind::city, 0.0, 1}), InputError);
  EXPECT_THROW(make_scene({SceneKind::city, std::nan(""), 1}), InputError);
  EXPECT_THROW(make_scene({SceneKind::city, 1e9, 1}), InputError);
}

TEST(Site, OverlapAgreesWithHandMadeCases) {
  const Footprint square{{0, 0}, 0.0, 2.0, 2.0};
  EXPECT_TRUE(overlap(square, {{1.9, 0}, 0.0, 2.0, 2.0}));
  EXPECT_FALSE(overlap(square, {{2.1, 0}, 0.0, 2.0, 2.0}));
  EXPECT_TRUE(overlap(square, {{2.1, 0}, 0.0, 2.0, 2.0}, 0.2));
  EXPECT_TRUE(overlap(square, {{2.3, 0}, M_PI / 4.0, 2.0, 2.0}));     // a corner reaches in
  EXPECT_FALSE(overlap(square, {{2.2, 2.2}, M_PI / 4.0, 2.0, 2.0}));  // boxes around them would overlap
}

}  // namespace
}  // namespace mlo::simulator
