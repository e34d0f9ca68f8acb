#include <gtest/gtest.h>

#include "mlo/simulator/simulate.hpp"
#include "mlo/training/example_source.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

TEST(OpenExamples, SimulatedDrivesAreLabelledAllRound) {
  for (const simulator::Layout layout : {simulator::Layout::tracking, simulator::Layout::odometry}) {
    const test::TempFolder folder;
    simulator::SimulationOptions options;
    options.scene = {.kind = simulator::SceneKind::city, .length_m = 40.0, .seed = 9};
    options.layout = layout;
    options.max_scans = 3;
    options.version = "test";
    simulate(options, folder.path() / "city", {});
    const auto source = open_examples(folder.path() / "city");
    ASSERT_EQ(source->size(), 3U);
    const ExampleReading reading = source->read(1);
    ASSERT_TRUE(reading.example) << reading.problem;
    EXPECT_FALSE(reading.example->view);
    std::size_t behind = 0;
    std::size_t close = 0;
    for (const TrainingBox& label : reading.example->boxes) {
      behind += label.demanded && label.box.center_lidar_m.x() < 0.0 ? 1U : 0U;
      if (label.occlusion > 0 || label.box.center_lidar_m.norm() > 25.0) continue;
      ++close;
      EXPECT_GT(label.points, 20U) << label.type;
    }
    EXPECT_GT(behind, 0U);
    EXPECT_GT(close, 0U);
  }
}

}  // namespace
}  // namespace mlo
