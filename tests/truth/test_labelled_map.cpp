#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/truth/labelled_map.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using test::TempFolder;

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// A folder as SemanticKITTI has it: scans of two points, one 10 m ahead (road), one 5 m left (a moving car).
Dataset open_labelled(const TempFolder& folder, std::size_t scans) {
  for (std::size_t frame = 0; frame < scans; ++frame) {
    const std::string name = "00000" + std::to_string(frame);
    folder.write("sequences/00/velodyne/" + name + ".bin",
                 bytes_of(std::vector<float>{10, 0, 0, 0.5F, 0, 5, 0, 0.5F}));
    folder.write("sequences/00/labels/" + name + ".label", bytes_of(std::vector<std::uint32_t>{40, 252}));
  }
  folder.write("sequences/00/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  folder.write("sequences/00/times.txt", "0\n0.1\n0.2\n");
  SensorConfig sensor;  // without a vertical correction
  return open_dataset(folder.path(), {.sequence = "00", .sensor = sensor});
}

PoseList steps_ahead(std::size_t count, double step_m) {
  PoseList poses;
  for (std::size_t i = 0; i < count; ++i) {
    poses.frames.push_back(i);
    poses.T_world_body.emplace_back(Eigen::Quaterniond::Identity(),
                                    Eigen::Vector3d(step_m * static_cast<double>(i), 0.0, 0.0));
  }
  return poses;
}

TEST(LabelledMap, PutsScansWhereThePosesSay) {
  const TempFolder folder;
  const Dataset dataset = open_labelled(folder, 2);
  const auto labels = find_point_labels(dataset);
  ASSERT_TRUE(labels);
  const LabelledMap map = build_labelled_map(dataset, *labels, steps_ahead(2, 1.0), 0.05);
  EXPECT_EQ(map.scans, 2U);
  EXPECT_TRUE(map.problems.empty());
  ASSERT_EQ(map.points.size(), 4U);
  EXPECT_TRUE(map.points[0].p_map.isApprox(Eigen::Vector3f(10, 0, 0)));
  EXPECT_EQ(map.points[0].mobility, Mobility::at_rest);
  EXPECT_TRUE(map.points[3].p_map.isApprox(Eigen::Vector3f(1, 5, 0)));
  EXPECT_EQ(map.points[3].mobility, Mobility::moving);
}

TEST(LabelledMap, KeepsOnePointPerVoxel) {
  const TempFolder folder;
  const Dataset dataset = open_labelled(folder, 3);
  EXPECT_EQ(build_labelled_map(dataset, *find_point_labels(dataset), steps_ahead(3, 0.0), 0.05).points.size(),
            2U);
}

TEST(LabelledMap, NamesTheScansThatDoNotFit) {
  const TempFolder folder;
  const Dataset dataset = open_labelled(folder, 3);
  folder.write("sequences/00/labels/000001.label", bytes_of(std::vector<std::uint32_t>{40}));
  const LabelledMap map = build_labelled_map(dataset, *find_point_labels(dataset), steps_ahead(2, 1.0), 0.05);
  EXPECT_EQ(map.scans, 1U);
  EXPECT_THAT(map.problems, testing::ElementsAre("frame 1: 1 labels for 2 points", "frame 2: no pose"));
}

TEST(LabelledMap, NoLabelsAreSaidToBeMissing) {
  const TempFolder folder;
  const Dataset dataset = open_labelled(folder, 1);
  std::filesystem::remove_all(folder.path() / "sequences/00/labels");
  EXPECT_FALSE(find_point_labels(dataset));
}

}  // namespace
}  // namespace mlo
