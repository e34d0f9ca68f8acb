#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "mlo/pipeline/close_loops.hpp"
#include "mlo/scene/scene_writer.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

constexpr double kSide_m = 60.0;
constexpr double kStep_m = 2.0;
constexpr float kReach_m = 40.0F;

/// Houses of different sizes beside a street around a square block, and the ground.
std::vector<Eigen::Vector3f> town() {
  std::mt19937 random(3);
  const auto between = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(random()) / 4294967295.0;
  };
  std::vector<Eigen::Vector3f> points;
  const auto add = [&](double x, double y, double z) {
    points.emplace_back(Eigen::Vector3d(x, y, z).cast<float>());
  };
  const auto wall = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to, double height) {
    const int count = static_cast<int>((to - from).norm() / 0.3);
    for (int i = 0; i <= count; ++i) {
      const Eigen::Vector2d p = from + (to - from) * i / std::max(1, count);
      for (double z = -1.7; z < height; z += 0.3) add(p.x(), p.y(), z);
    }
  };
  for (int side = 0; side < 4; ++side) {
    const Eigen::Rotation2Dd turn(0.5 * std::numbers::pi * side);
    const Eigen::Vector2d corner = Eigen::Vector2d(0.5 * kSide_m, 0.5 * kSide_m) +
                                   turn * Eigen::Vector2d(-0.5 * kSide_m, -0.5 * kSide_m);
    for (const double across : {-1.0, 1.0}) {
      for (double along = between(0.0, 4.0); along < kSide_m - 12.0; along += between(9.0, 14.0)) {
        const double front = across * between(6.0, 9.0);
        const double width = between(4.0, 8.0);
        const double height = between(1.0, 6.0);
        const auto at = [&](double a, double b) {
          return Eigen::Vector2d(corner + turn * Eigen::Vector2d(a, b));
        };
        wall(at(along, front), at(along + width, front), height);
        wall(at(along, front), at(along, front + across * 4.0), height);
        wall(at(along + width, front), at(along + width, front + across * 4.0), height);
      }
    }
  }
  for (double x = -20.0; x < kSide_m + 20.0; x += 0.8) {
    for (double y = -20.0; y < kSide_m + 20.0; y += 0.8) add(x, y, -1.7);
  }
  return points;
}

/// Around the block, counter-clockwise from a corner; whole turns at the corners.
SE3 pose_on_square(double way_m) {
  const int side = static_cast<int>(way_m / kSide_m);
  const Eigen::Rotation2Dd turn(0.5 * std::numbers::pi * side);
  const Eigen::Vector2d corner =
      Eigen::Vector2d(0.5 * kSide_m, 0.5 * kSide_m) + turn * Eigen::Vector2d(-0.5 * kSide_m, -0.5 * kSide_m);
  const Eigen::Vector2d p = corner + turn * Eigen::Vector2d(way_m - side * kSide_m, 0.0);
  return {so3_exp({0.0, 0.0, turn.angle()}), {p.x(), p.y(), 0.0}};
}

SceneCloud seen_from(const std::vector<Eigen::Vector3f>& points, const SE3& T_world_lidar) {
  const SE3 T_lidar_world = T_world_lidar.inverse();
  SceneCloud cloud;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3f p_lidar = (T_lidar_world * p.cast<double>()).cast<float>();
    if (p_lidar.norm() < kReach_m) cloud.add({p_lidar, 0.0F}, MapLabel::surface);
  }
  return cloud;
}

/// The scene of a run whose estimate turns a little too little, over a way.
void write_scene(const std::filesystem::path& file, double way_m) {
  const std::vector<Eigen::Vector3f> points = town();
  SceneWriter writer(file, SceneMeta(), {});
  SE3 T_map_lidar;
  for (double way = 0.0; way <= way_m; way += kStep_m) {
    if (way > 0.0) {
      const SE3 step = pose_on_square(way - kStep_m).inverse() * pose_on_square(way);
      T_map_lidar = T_map_lidar * SE3(step.rotation() * so3_exp({0.0, 0.0, -3e-4}), step.translation());
    }
    const auto frame = static_cast<std::uint64_t>(std::lround(way / kStep_m));
    SceneScan scan{
        .frame = frame, .stamp_s = 0.1 * way, .status = ScanStatus::localised, .T_map_lidar = T_map_lidar};
    const SceneCloud cloud = seen_from(points, pose_on_square(way));
    writer.write(scan, &cloud);
  }
  writer.finish();
}

double error_at_end_m(const SceneFile& scene, const std::vector<SE3>& corrections) {
  const std::size_t last = scene.num_scans() - 1;
  SE3 T_map_lidar = scene.scan(last).T_map_lidar;
  if (!corrections.empty()) T_map_lidar = corrections[last] * T_map_lidar;
  const double way_m = kStep_m * static_cast<double>(last);
  return (T_map_lidar.translation() - pose_on_square(way_m).translation()).norm();
}

TEST(CloseLoops, AWayAroundABlockMeetsItsBeginning) {
  const test::TempFolder folder;
  write_scene(folder.path() / "scene.mlo", 4.0 * kSide_m + 24.0);
  const SceneFile scene(folder.path() / "scene.mlo");
  const ClosedLoops closed = close_loops(scene, {});
  EXPECT_GE(closed.loops, 5U);
  ASSERT_EQ(closed.corrections.size(), scene.num_scans());
  EXPECT_GT(error_at_end_m(scene, {}), 1.0);
  EXPECT_LT(error_at_end_m(scene, closed.corrections), 0.1);
  EXPECT_LT(closed.corrections[0].log().norm(), 1e-6);  // the beginning stays
}

TEST(CloseLoops, AWayThatDoesNotComeBackStays) {
  const test::TempFolder folder;
  write_scene(folder.path() / "scene.mlo", 2.5 * kSide_m);
  const ClosedLoops closed = close_loops(SceneFile(folder.path() / "scene.mlo"), {});
  EXPECT_EQ(closed.loops, 0U);
  EXPECT_TRUE(closed.corrections.empty());
}

TEST(CloseLoops, AnEmptySceneHasNone) {
  const test::TempFolder folder;
  SceneWriter(folder.path() / "scene.mlo", SceneMeta(), {}).finish();
  EXPECT_EQ(close_loops(SceneFile(folder.path() / "scene.mlo"), {}).loops, 0U);
}

}  // namespace
}  // namespace mlo
