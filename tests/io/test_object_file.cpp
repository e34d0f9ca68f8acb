#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/object_file.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;

std::string problem_of(const TempFolder& folder, const std::string& content) {
  try {
    read_objects_csv(folder.write("objects.csv", content));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

constexpr const char* kHeader = "frame,id,class,x_m,y_m,z_m,qx,qy,qz,qw\n";

TEST(ObjectFile, RoundTrip) {
  const TempFolder folder;
  ObjectPose object;
  object.frame = 12;
  object.stamp_s = 1.25;
  object.id = 7;
  object.type = "car";
  object.state = "moving";
  object.T_map_object =
      SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())), {1.5, -2.25, 0.125});
  object.size_lwh_m = {4.5, 1.75, 1.5};
  object.points = 33;
  ObjectPose bare;
  bare.frame = 3;
  bare.type = "van";
  const auto file = folder.path() / "objects.csv";
  write_objects_csv(file, std::vector<ObjectPose>{object, bare});
  const std::vector<ObjectPose> read = read_objects_csv(file);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].frame, 3U);  // sorted by frame
  EXPECT_FALSE(read[0].stamp_s || read[0].points);
  EXPECT_EQ(read[0].state, "");
  EXPECT_EQ(read[1].stamp_s, 1.25);
  EXPECT_EQ(read[1].id, 7);
  EXPECT_EQ(read[1].type, "car");
  EXPECT_EQ(read[1].state, "moving");
  EXPECT_EQ(read[1].points, 33U);
  EXPECT_TRUE(read[1].size_lwh_m.isApprox(object.size_lwh_m));
  EXPECT_LT((read[1].T_map_object.inverse() * object.T_map_object).log().norm(), 1e-7);
}

TEST(ObjectFile, ColumnsInAnyOrderAndOthersPassedOver) {
  const TempFolder folder;
  const auto file = folder.write("objects.csv",
                                 "class,colour,id,frame,qw,qx,qy,qz,x_m,y_m,z_m\n"
                                 "Car,red,4,0,1,0,0,0,1,2,3\n");
  const std::vector<ObjectPose> read = read_objects_csv(file);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].type, "car");
  EXPECT_EQ(read[0].id, 4);
  EXPECT_EQ(read[0].T_map_object.translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_TRUE(read[0].size_lwh_m.isZero());
}

TEST(ObjectFile, OnlyAHeaderIsNoObjects) {
  const TempFolder folder;
  EXPECT_TRUE(read_objects_csv(folder.write("objects.csv", kHeader)).empty());
}

TEST(ObjectFile, MistakesNameFileAndLine) {
  const TempFolder folder;
  const std::string header = kHeader;
  EXPECT_THAT(problem_of(folder, ""), HasSubstr("header"));
  EXPECT_THAT(problem_of(folder, "frame,id\n0,1\n"),
              AllOf(HasSubstr("objects.csv:2"), HasSubstr("no class")));
  EXPECT_THAT(problem_of(folder, header + "0,1,car,0,0,0,0,0,0,1\n0,2,car,0,0,nan,0,0,0,1\n"),
              AllOf(HasSubstr("objects.csv:3"), HasSubstr("z_m")));
  EXPECT_THAT(problem_of(folder, header + "0,1,car,0,0,0,0,0,0,0\n"), HasSubstr("no rotation"));
  EXPECT_THAT(problem_of(folder, header + "0,1,car,0,0,0,0,0,0\n"), HasSubstr("9 values under 10"));
  EXPECT_THAT(problem_of(folder, header + "0.5,1,car,0,0,0,0,0,0,1\n"), HasSubstr("whole number"));
  EXPECT_THAT(problem_of(folder, header + "0,1,car,0,0,0,0,0,0,1\n0,1,van,9,0,0,0,0,0,1\n"),
              HasSubstr("object 1 stands twice in frame 0"));
}

}  // namespace
}  // namespace mlo
