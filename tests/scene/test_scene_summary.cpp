#include <gtest/gtest.h>

#include "mlo/scene/scene_summary.hpp"
#include "scene/small_scene.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

TEST(SceneSummary, CountsWhatIsThere) {
  const test::TempFolder folder;
  test::write_small_scene(folder.path() / "scene.mlo", 4);
  const SceneSummary summary = summarize(SceneFile(folder.path() / "scene.mlo"));
  EXPECT_EQ(summary.scans, 4U);
  EXPECT_EQ(summary.by_status[static_cast<std::size_t>(ScanStatus::localised)], 4U);
  EXPECT_NEAR(summary.last_stamp_s - summary.first_stamp_s, 0.3, 1e-9);
  double path_m = 0.0;
  for (std::size_t i = 1; i < 4; ++i) {
    path_m +=
        (test::small_scan(i).T_map_lidar.translation() - test::small_scan(i - 1).T_map_lidar.translation())
            .norm();
  }
  EXPECT_NEAR(summary.path_m, path_m, 1e-9);
  EXPECT_EQ(summary.objects, (std::map<std::string, std::size_t>{{"van", 1}}));
  EXPECT_EQ(summary.objects_moving, 1U);
  EXPECT_EQ(summary.map_points, test::small_map().size());
}

TEST(SceneSummary, OfNothingIsNothing) {
  const test::TempFolder folder;
  test::write_small_scene(folder.path() / "scene.mlo", 0, false);
  const SceneSummary summary = summarize(SceneFile(folder.path() / "scene.mlo"));
  EXPECT_EQ(summary.scans, 0U);
  EXPECT_EQ(summary.path_m, 0.0);
  EXPECT_TRUE(summary.objects.empty());
}

}  // namespace
}  // namespace mlo
