#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/scene/scene_state.hpp"
#include "scene/small_scene.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

class State : public testing::Test {
 protected:
  State() { test::write_small_scene(path_, 4); }

  test::TempFolder folder_;
  std::filesystem::path path_ = folder_.path() / "scene.mlo";
};

TEST_F(State, AtAStampIsThatOfTheScan) {
  const SceneFile scene(path_);
  for (std::size_t i = 0; i < 4; ++i) {
    const SceneScan scan = test::small_scan(i);
    const SceneState state = state_at(scene, scan.stamp_s);
    EXPECT_EQ(state.frame, scan.frame);
    EXPECT_TRUE(state.T_map_lidar.matrix().isApprox(scan.T_map_lidar.matrix(), 1e-12));
    ASSERT_EQ(state.objects.size(), 1U);
    EXPECT_TRUE(
        state.objects[0].T_map_object.matrix().isApprox(scan.objects[0].T_map_object.matrix(), 1e-12));
  }
}

// The robot moves by the same increment in every scan: all between lies on the same screw.
TEST_F(State, BetweenTwoScansIsOnTheWay) {
  const SceneFile scene(path_);
  const SE3 before = test::small_scan(1).T_map_lidar;
  const SE3 motion = before.inverse() * test::small_scan(2).T_map_lidar;
  for (const double share : {0.2, 0.4, 0.9}) {
    const SceneState state = state_at(scene, 100.1 + 0.1 * share);
    EXPECT_EQ(state.frame, share < 0.5 ? 11U : 12U);
    EXPECT_TRUE(state.T_map_lidar.matrix().isApprox((before * interpolate(motion, share)).matrix(), 1e-9));
    EXPECT_NEAR(state.objects.at(0).T_map_object.translation().x(), 0.5 * (1.0 + share), 1e-9);
    EXPECT_NEAR(state.objects.at(0).velocity_map_mps.x(), 1.0 + share, 1e-9);
  }
}

TEST_F(State, AnObjectOfOneScanOnlyBelongsToThatOne) {
  {
    SceneWriter writer(path_, SceneMeta(), {});
    writer.write(test::small_scan(0), nullptr);
    SceneScan without = test::small_scan(1);
    without.objects.clear();
    writer.write(without, nullptr);
  }
  const SceneFile scene(path_);
  EXPECT_EQ(state_at(scene, 100.02).objects.size(), 1U);
  EXPECT_EQ(state_at(scene, 100.08).objects.size(), 0U);
}

TEST_F(State, OutsideOfTheSceneIsAnInputErrorThatNamesItsTimes) {
  const SceneFile scene(path_);
  for (const double stamp_s : {99.9, 100.31}) {
    try {
      state_at(scene, stamp_s);
      FAIL() << stamp_s;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("from 100.000000 s to 100.300000 s"));
    }
  }
}

TEST_F(State, WithoutScansThereIsNone) {
  test::write_small_scene(path_, 0);
  EXPECT_THROW(state_at(SceneFile(path_), 0.0), InputError);
}

}  // namespace
}  // namespace mlo
