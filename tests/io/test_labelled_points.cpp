#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/labelled_points.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using test::TempFolder;

std::string problem_of(const std::filesystem::path& file) {
  try {
    read_labelled_cloud(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string pcd(const std::string& fields, const std::string& sizes, const std::string& types,
                const std::string& counts, const std::string& rows, int points) {
  const std::string number = std::to_string(points);
  return "VERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " + types + "\nCOUNT " + counts +
         "\nWIDTH " + number + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number + "\nDATA ascii\n" +
         rows;
}

TEST(LabelledPoints, SemanticKittiClasses) {
  EXPECT_EQ(mobility_of(0), Mobility::unknown);
  EXPECT_EQ(mobility_of(1), Mobility::unknown);
  EXPECT_EQ(mobility_of(10), Mobility::at_rest);  // a parked car
  EXPECT_EQ(mobility_of(40), Mobility::at_rest);  // road
  EXPECT_EQ(mobility_of(10, Movable::is_left_out), Mobility::unknown);
  EXPECT_EQ(mobility_of(32, Movable::is_left_out), Mobility::unknown);
  EXPECT_EQ(mobility_of(40, Movable::is_left_out), Mobility::at_rest);
  EXPECT_EQ(mobility_of(252, Movable::is_left_out), Mobility::moving);
  EXPECT_EQ(mobility_of(251), Mobility::at_rest);
  EXPECT_EQ(mobility_of(252), Mobility::moving);
  EXPECT_EQ(mobility_of(259), Mobility::moving);
  EXPECT_EQ(mobility_of((7U << 16U) | 252U), Mobility::moving);  // of object 7
  EXPECT_EQ(mobility_of(7U << 16U), Mobility::unknown);
}

TEST(LabelledPoints, LabelsOfAScan) {
  const TempFolder folder;
  const std::uint32_t labels[] = {252U, (3U << 16U) | 10U};
  const std::string bytes(reinterpret_cast<const char*>(labels), sizeof(labels));
  EXPECT_THAT(read_semantic_labels(folder.write("a.label", bytes)),
              testing::ElementsAre(252U, (3U << 16U) | 10U));
  EXPECT_TRUE(read_semantic_labels(folder.write("empty.label", "")).empty());
  EXPECT_THROW(read_semantic_labels(folder.write("cut.label", bytes.substr(0, 7))), InputError);
  EXPECT_THROW(read_semantic_labels(folder.path() / "missing.label"), InputError);
}

TEST(LabelledPoints, ALabelFieldOutranksIntensity) {
  const TempFolder folder;
  const auto file =
      folder.write("map.pcd", pcd("x y z intensity label", "4 4 4 4 4", "F F F F U", "1 1 1 1 1",
                                  "1 2 3 1 40\n4 5 6 0 252\nnan 0 0 0 252\n0 0 0 0 0\n", 4));
  const auto points = read_labelled_cloud(file);
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].mobility, Mobility::at_rest);
  EXPECT_EQ(points[0].p_map, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  EXPECT_EQ(points[1].mobility, Mobility::moving);
  EXPECT_EQ(points[2].mobility, Mobility::unknown);
}

TEST(LabelledPoints, IntensityOneMoves) {
  const TempFolder folder;
  const auto file = folder.write(
      "gt.pcd", pcd("x y z intensity", "4 4 4 4", "F F F F", "1 1 1 1", "1 2 3 1\n4 5 6 0\n7 8 9 nan\n", 3));
  const auto points = read_labelled_cloud(file);
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].mobility, Mobility::moving);
  EXPECT_EQ(points[1].mobility, Mobility::at_rest);
  EXPECT_EQ(points[2].mobility, Mobility::unknown);
}

TEST(LabelledPoints, WithoutLabelsTheRemedyIsNamed) {
  const TempFolder folder;
  const auto file = folder.write("bare.pcd", pcd("x y z", "4 4 4", "F F F", "1 1 1", "1 2 3\n", 1));
  EXPECT_THAT(problem_of(file), testing::AllOf(testing::HasSubstr("bare.pcd"), testing::HasSubstr("label")));
  EXPECT_THAT(problem_of(folder.write("map.txt", "")), testing::HasSubstr("convert"));
}

}  // namespace
}  // namespace mlo
