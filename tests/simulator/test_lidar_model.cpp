#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mlo/core/azimuth.hpp"
#include "mlo/io/sweep_structure.hpp"
#include "mlo/simulator/lidar_model.hpp"
#include "simulator/small_scene.hpp"

namespace mlo::simulator {
namespace {

SensorConfig coarse_hdl64e() {
  SensorConfig sensor = hdl64e();
  sensor.columns = 360;
  return sensor;
}

Sweep sweep_of(const Scene& scene, const LidarErrors& errors, std::uint64_t seed = 1,
               std::uint64_t frame = 0) {
  RayWorld world(scene);
  return scan(scene, world, coarse_hdl64e(), errors, 1.0, frame, seed);
}

LidarErrors no_errors() {
  LidarErrors errors;
  errors.range_noise_m = errors.random_loss = errors.loss_level = 0.0;
  return errors;
}

TEST(LidarModel, PointsComeRingByRingByAzimuthFromAhead) {
  const Sweep sweep = sweep_of(small_scene(), {});
  ASSERT_GT(sweep.points.size(), 5000U);
  for (std::size_t i = 1; i < sweep.points.size(); ++i) {
    const Point& a = sweep.points[i - 1].measured;
    const Point& b = sweep.points[i].measured;
    ASSERT_LE(a.ring, b.ring);
    if (a.ring == b.ring) {
      EXPECT_LT(azimuth_turns(a.p_lidar.x(), a.p_lidar.y()), azimuth_turns(b.p_lidar.x(), b.p_lidar.y()));
    }
  }
}

TEST(LidarModel, TimesRunClockwiseFromBehind) {
  const Sweep sweep = sweep_of(small_scene(), {});
  EXPECT_NEAR(sweep.stamp_s, 1.05, 1e-9);
  for (const SimulatedPoint& point : sweep.points) {
    const double azimuth = std::atan2(point.measured.p_lidar.y(), point.measured.p_lidar.x());
    EXPECT_NEAR(point.measured.sweep_fraction, 0.5 * (1.0 - azimuth / M_PI), 1e-5);
  }
}

TEST(LidarModel, WithoutErrorsPointsPlacedByTheirOwnPoseLieOnTheScene) {
  const Scene scene = small_scene();
  for (const SimulatedPoint& point : sweep_of(scene, no_errors()).points) {
    const double time = 1.0 + 0.1 * point.measured.sweep_fraction;
    const Eigen::Vector3d placed =
        scene.robot.T_world_lidar(scene.terrain, time) * point.measured.p_lidar.cast<double>();
    EXPECT_NEAR((placed - point.p_world.cast<double>()).norm(), 0.0, 1e-4);
    if (point.surface == Surface::road) {
      EXPECT_NEAR(placed.z(), 0.0, 1e-3);
    }
  }
}

TEST(LidarModel, RangeNoiseHasTheGivenSpreadAndNoBias) {
  LidarErrors errors = no_errors();
  errors.range_noise_m = 0.03;
  const Scene scene = small_scene();
  double sum = 0.0, squares = 0.0;
  const Sweep sweep = sweep_of(scene, errors);
  for (const SimulatedPoint& point : sweep.points) {
    const SE3 T_world_lidar =
        scene.robot.T_world_lidar(scene.terrain, 1.0 + 0.1 * point.measured.sweep_fraction);
    const double error =
        point.measured.p_lidar.norm() - (point.p_world.cast<double>() - T_world_lidar.translation()).norm();
    sum += error;
    squares += error * error;
  }
  const auto count = static_cast<double>(sweep.points.size());
  EXPECT_NEAR(sum / count, 0.0, 4.0 * 0.03 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 0.03, 0.001);
}

TEST(LidarModel, TheSameForAnyNumberOfThreadsAndDifferentForAnotherFrameOrSeed) {
  const Scene scene = small_scene();
  const auto coordinates = [](const Sweep& sweep) {
    std::vector<float> values;
    for (const SimulatedPoint& point : sweep.points) {
      values.insert(values.end(), {point.measured.p_lidar.x(), point.measured.p_lidar.y(),
                                   point.measured.p_lidar.z(), point.measured.intensity});
    }
    return values;
  };
  const std::vector<float> many = coordinates(sweep_of(scene, {}));
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(many, coordinates(sweep_of(scene, {})));
  }
  EXPECT_NE(many, coordinates(sweep_of(scene, {}, 2)));
  EXPECT_NE(many, coordinates(sweep_of(scene, {}, 1, 1)));
}

TEST(LidarModel, FarAndGrazingReturnsAreLostMoreOften) {
  const auto share_of_ground = [](double nearer_m, double farther_m) {
    LidarErrors all = no_errors();
    LidarErrors lossy = no_errors();
    lossy.loss_level = LidarErrors{}.loss_level;
    const auto count = [&](const LidarErrors& errors) {
      double n = 0.0;
      for (const SimulatedPoint& point : sweep_of(small_scene(), errors).points) {
        const double range = point.measured.p_lidar.norm();
        n += point.surface == Surface::road && range >= nearer_m && range < farther_m ? 1.0 : 0.0;
      }
      return n;
    };
    return count(lossy) / count(all);
  };
  EXPECT_GT(share_of_ground(5.0, 15.0), 0.99);
  EXPECT_LT(share_of_ground(55.0, 80.0), 0.9);
  EXPECT_GT(share_of_ground(55.0, 80.0), 0.2);
}

TEST(LidarModel, ElevationBiasIsUndoneByTheReadersCorrection) {
  LidarErrors errors = no_errors();
  errors.elevation_bias_deg = 0.205;
  const Sweep straight_sweep = sweep_of(small_scene(), no_errors());
  const Sweep biased = sweep_of(small_scene(), errors);
  ASSERT_EQ(straight_sweep.points.size(), biased.points.size());
  std::vector<Point> corrected;
  for (const SimulatedPoint& point : biased.points) corrected.push_back(point.measured);
  correct_vertical_angle(corrected, 0.205);
  for (std::size_t i = 0; i < corrected.size(); ++i) {
    EXPECT_NEAR((corrected[i].p_lidar - straight_sweep.points[i].measured.p_lidar).norm(), 0.0F, 1e-3F);
  }
}

TEST(LidarModel, NoPointBeyondTheRangesOrUnderTheRoof) {
  LidarErrors errors = no_errors();
  errors.max_range_m = 30.0;
  const Sweep sweep = sweep_of(small_scene(), errors);
  for (const SimulatedPoint& point : sweep.points) {
    EXPECT_LT(point.measured.p_lidar.norm(), 30.01F);
    EXPECT_GT(point.measured.p_lidar.norm(), coarse_hdl64e().min_range_m);
  }
  errors.own_roof = false;
  EXPECT_GT(sweep_of(small_scene(), errors).points.size(), sweep.points.size());
}

TEST(LidarModel, RingsAreRecoveredFromTheOrderOfTheFile) {
  const Sweep sweep = sweep_of(make_scene({SceneKind::city, 50.0, 3}), {});
  std::vector<Point> points;
  for (const SimulatedPoint& point : sweep.points) points.push_back(point.measured);
  for (Point& point : points) point.ring = Point::kNoRing;
  const RingRecovery recovery = recover_rings(points, coarse_hdl64e());
  ASSERT_TRUE(recovery.recovered) << recovery.problem;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    wrong += points[i].ring != sweep.points[i].measured.ring ? 1U : 0U;
  EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace mlo::simulator
