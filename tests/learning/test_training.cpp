#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/safetensors.hpp"
#include "mlo/learning/level_example.hpp"
#include "mlo/learning/training.hpp"
#include "mlo/network/network.hpp"
#include "mlo/simulator/simulate.hpp"
#include "network/tiny_network.hpp"
#include "temp_folder.hpp"
#include "training/made_example.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

/// A short drive of a coarse lidar, and a tiny network to begin with.
class Training : public ::testing::Test {
 protected:
  void SetUp() override {
    simulator::SimulationOptions drive;
    drive.scene.seed = 4;
    drive.scene.length_m = 40.0;
    drive.max_scans = 5;
    drive.sensor.columns = 360;
    simulator::simulate(drive, folder_.path() / "drive", {});
    write_safetensors(folder_.path() / "start.safetensors", test::random_weights(test::tiny_architecture()));
    config_.epochs = 2;
    config_.batch = 2;
    config_.learning_rate = 0.001;
  }

  /// @param stop_after  steps; 0: never
  TrainingReport train_into(const std::string& out, bool resume = false, long stop_after = 0) {
    const TrainingOptions options{.folders = {folder_.path() / "drive"},
                                  .validation = {folder_.path() / "drive"},
                                  .out = folder_.path() / out,
                                  .resume = resume,
                                  .validate_every = 1,
                                  .max_validation = 2,
                                  .start = folder_.path() / "start.safetensors"};
    long steps = 0;
    const auto count = [&](const TrainingProgress& progress) {
      if (progress.phase == TrainingProgress::Phase::training && !progress.row) ++steps;
    };
    return train(config_, options, count, [&] { return stop_after > 0 && steps >= stop_after; });
  }
  std::string file(const std::string& out, const std::string& name) const {
    return content_of(folder_.path() / out / name);
  }

  test::TempFolder folder_;
  TrainingConfig config_;
};

TEST_F(Training, WritesWeightsThatANetworkTakesAndCurves) {
  const TrainingReport report = train_into("out");
  EXPECT_EQ(report.examples, 5U);
  EXPECT_EQ(report.steps, 4);  // two epochs of two whole batches
  EXPECT_FALSE(report.interrupted);
  ASSERT_EQ(report.rows.size(), 4U);
  EXPECT_EQ(report.rows.back().ap.size(), 2U);
  EXPECT_GT(report.rows.front().loss.total(), 0.0);
  const Network network(read_safetensors(folder_.path() / "out/weights.safetensors"));
  EXPECT_EQ(to_json(network.architecture()), to_json(test::tiny_architecture()));
  EXPECT_THAT(file("out", "curves.csv"), ::testing::HasSubstr("ap_pedestrian"));
  EXPECT_THAT(file("out", "curves.svg"), ::testing::HasSubstr("</svg>"));
}

TEST_F(Training, GivesTheSameBytesResumedOrNot) {
  train_into("through");
  EXPECT_TRUE(train_into("resumed", false, 3).interrupted);
  EXPECT_FALSE(fs::exists(folder_.path() / "resumed/weights.safetensors"));
  const TrainingReport report = train_into("resumed", true);
  EXPECT_EQ(report.rows.size(), 4U);
  for (const char* name : {"weights.safetensors", "training_state.safetensors", "curves.csv"}) {
    EXPECT_EQ(file("through", name), file("resumed", name)) << name;
  }
}

TEST_F(Training, RefusesTheStateOfAnother) {
  train_into("out", false, 2);
  config_.learning_rate = 0.002;
  EXPECT_THROW(train_into("out", true), InputError);
}

TEST(Level, PutsPointsAndBoxesAboveTheGround) {
  const NetworkInputSpec spec = small_architecture().input;
  // As much ground as a lidar sees: where objects are most of what is seen, some of them is taken for it.
  const TrainingExample street = test::made_street(3);
  const std::vector<LabelledBox> labels(street.boxes.begin(), street.boxes.end());
  const TrainingExample before =
      make_example("street", test::made_points(labels, 3, 40, 60000), labels, std::nullopt, 5);
  const std::optional<TrainingExample> after = level(before, spec);
  ASSERT_TRUE(after);
  ASSERT_EQ(after->boxes.size(), before.boxes.size());
  for (const TrainingBox& box : after->boxes) {
    EXPECT_NEAR(box.box.center_lidar_m.z() - 0.5 * box.box.size_lwh_m.z(), 0.0, 0.1);
  }
  for (const Point& point : after->points) EXPECT_GT(point.p_lidar.z(), -0.5F);
  EXPECT_FALSE(level(test::made_example({}), spec));  // ground alone leaves nothing to learn from
}

TEST(Level, DemandsKnownClassesAlone) {
  TrainingExample example = test::made_street(3);
  example.boxes[0].demanded = false;
  const std::vector<TargetBox> targets = target_boxes(example, test::tiny_architecture());
  ASSERT_EQ(targets.size(), example.boxes.size());
  EXPECT_EQ(targets[0].class_index, TargetBox::kIgnored);
  EXPECT_EQ(targets[1].class_index, 1);
  EXPECT_EQ(targets[2].class_index, 0);
}

}  // namespace
}  // namespace mlo
