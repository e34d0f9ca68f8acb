#include <gtest/gtest.h>

#include "mlo/mapping/mover_trails.hpp"

namespace mlo {
namespace {

const Eigen::Vector3d kTrailSize(4.0, 2.0, 1.5);
constexpr double kScan_s = 0.1;

TrailedObject car(long id, double x_m, bool moves, double speed_mps = 10.0) {
  return {.id = id,
          .T_map_object = {Eigen::Quaterniond::Identity(), {x_m, 2.0, 0.0}},
          .size_lwh_m = kTrailSize,
          .velocity_map_mps = {speed_mps, 0.0},
          .moves = moves};
}

/// Scans without anything followed, so that there is a past.
void pass_scans(MoverTrails& trails, std::size_t first, std::size_t last) {
  for (std::size_t frame = first; frame < last; ++frame)
    trails.update(frame, kScan_s * static_cast<double>(frame), {});
}

TEST(MoverTrails, GoesBackAtConstantVelocityToBeforeTheObjectWasFollowed) {
  MoverTrails trails(0.35);
  pass_scans(trails, 0, 10);
  const TrailedObject object = car(3, 20.0, true);
  const Trails found = trails.update(10, 1.0, {&object, 1});
  ASSERT_EQ(found.before.size(), 3U) << "scans within 0.35 s";
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(found.before[i].frame, 9 - i);
    EXPECT_NEAR(found.before[i].T_map_object.translation().x(), 19.0 - static_cast<double>(i), 1e-9);
    EXPECT_EQ(found.before[i].size_lwh_m, kTrailSize);
  }
  EXPECT_TRUE(found.now.empty());
  EXPECT_TRUE(trails.update(11, 1.1, {&object, 1}).before.empty()) << "once";
}

TEST(MoverTrails, TakesItsOwnPosesWhileItWasFollowed) {
  MoverTrails trails(0.45);
  pass_scans(trails, 0, 8);
  for (std::size_t frame = 8; frame < 10; ++frame) {
    const TrailedObject object = car(3, 50.0, false);
    EXPECT_TRUE(trails.update(frame, kScan_s * static_cast<double>(frame), {&object, 1}).before.empty());
  }
  const TrailedObject object = car(3, 51.0, true);
  const Trails found = trails.update(10, 1.0, {&object, 1});
  ASSERT_EQ(found.before.size(), 4U);
  EXPECT_EQ(found.before[0].T_map_object.translation().x(), 50.0);
  EXPECT_EQ(found.before[1].T_map_object.translation().x(), 50.0);
  EXPECT_NEAR(found.before[2].T_map_object.translation().x(), 49.0, 1e-9);
  EXPECT_NEAR(found.before[3].T_map_object.translation().x(), 48.0, 1e-9);
}

TEST(MoverTrails, GoesOnAfterTheObjectWasLostForAsLong) {
  MoverTrails trails(0.25);
  const TrailedObject object = car(3, 20.0, true);
  trails.update(0, 0.0, {&object, 1});
  const Trails first = trails.update(1, 0.1, {});
  ASSERT_EQ(first.now.size(), 1U);
  EXPECT_NEAR(first.now[0].T_map_object.translation().x(), 21.0, 1e-9);
  EXPECT_EQ(trails.update(2, 0.2, {}).now.size(), 1U);
  EXPECT_TRUE(trails.update(3, 0.3, {}).now.empty());
}

TEST(MoverTrails, WhatRestsLeavesNoTrail) {
  MoverTrails trails(1.0);
  const TrailedObject object = car(3, 20.0, false);
  EXPECT_TRUE(trails.update(0, 0.0, {&object, 1}).before.empty());
  EXPECT_TRUE(trails.update(1, 0.1, {&object, 1}).before.empty());
  EXPECT_TRUE(trails.update(2, 0.2, {}).now.empty());
}

TEST(MoverTrails, OfNoLengthIsNone) {
  MoverTrails trails(0.0);
  trails.update(0, 0.0, {});
  const TrailedObject object = car(3, 20.0, true);
  EXPECT_TRUE(trails.update(1, 0.1, {&object, 1}).before.empty());
  EXPECT_TRUE(trails.update(2, 0.2, {}).now.empty());
}

TEST(MoverTrails, GoesOnFromAnArchive) {
  MoverTrails trails(1.0);
  const TrailedObject resting = car(3, 20.0, false);
  const TrailedObject moving = car(4, 20.0, true);
  const std::vector<TrailedObject> both{resting, moving};
  trails.update(0, 0.0, both);
  ArchiveWriter writer;
  writer(trails);
  MoverTrails read(1.0);
  ArchiveReader reader(writer.bytes(), "archive");
  reader(read);
  const TrailedObject started = car(3, 20.5, true);
  for (MoverTrails* each : {&trails, &read}) {
    const Trails found = each->update(1, 0.1, {&started, 1});
    ASSERT_EQ(found.before.size(), 1U);
    EXPECT_EQ(found.before[0].T_map_object.translation().x(), 20.0);
    ASSERT_EQ(found.now.size(), 1U);
    EXPECT_NEAR(found.now[0].T_map_object.translation().x(), 21.0, 1e-9);
  }
}

}  // namespace
}  // namespace mlo
