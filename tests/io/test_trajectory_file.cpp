#include <fstream>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using test::TempFolder;

PoseList random_poses(std::size_t count) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  PoseList poses;
  for (std::size_t i = 0; i < count; ++i) {
    SE3::Tangent xi;
    for (int k = 0; k < 6; ++k) xi(k) = uniform(rng) * (k < 3 ? 100.0 : 1.7);
    poses.frames.push_back(i);
    poses.stamps_s.push_back(1317000000.0 + 0.1 * static_cast<double>(i));
    poses.T_world_body.push_back(SE3::exp(xi));
  }
  return poses;
}

std::string content(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::string message_of(const std::filesystem::path& path) {
  try {
    read_trajectory(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(TrajectoryFile, KittiRowsRoundTrip) {
  const TempFolder folder;
  const PoseList poses = random_poses(50);
  write_kitti_poses(folder.path() / "kitti.txt", poses);
  const PoseList read = read_trajectory(folder.path() / "kitti.txt");
  EXPECT_EQ(read.frames, poses.frames);
  EXPECT_TRUE(read.stamps_s.empty());
  ASSERT_EQ(read.T_world_body.size(), poses.T_world_body.size());
  for (std::size_t i = 0; i < poses.T_world_body.size(); ++i) {
    EXPECT_EQ(read.T_world_body[i].translation(), poses.T_world_body[i].translation());
    EXPECT_TRUE(
        read.T_world_body[i].rotation().isApprox(poses.T_world_body[i].rotation(), 1e-14) ||
        read.T_world_body[i].rotation().coeffs().isApprox(-poses.T_world_body[i].rotation().coeffs(), 1e-14));
  }
}

TEST(TrajectoryFile, TumRowsRoundTripToTheLastBitOfStampAndTranslation) {
  const TempFolder folder;
  const PoseList poses = random_poses(50);
  write_tum_poses(folder.path() / "tum.txt", poses);
  const PoseList read = read_trajectory(folder.path() / "tum.txt");
  EXPECT_EQ(read.stamps_s, poses.stamps_s);
  EXPECT_EQ(read.frames, poses.frames);
  ASSERT_EQ(read.T_world_body.size(), poses.T_world_body.size());
  for (std::size_t i = 0; i < poses.T_world_body.size(); ++i) {
    EXPECT_EQ(read.T_world_body[i].translation(), poses.T_world_body[i].translation());
    EXPECT_LT((read.T_world_body[i].inverse() * poses.T_world_body[i]).rotation_angle_rad(), 1e-14);
  }
}

TEST(TrajectoryFile, KnownRowsAreReadAndWrittenAsExpected) {
  const TempFolder folder;
  const auto file = folder.write("a.txt", " 0 -1 0 1.5\t1 0 0 -2 0 0 1 3e-1 \r\n");
  const PoseList poses = read_trajectory(file);
  ASSERT_EQ(poses.T_world_body.size(), 1U);
  EXPECT_EQ(poses.frames.front(), 0U);
  EXPECT_TRUE((poses.T_world_body[0] * Eigen::Vector3d(1.0, 0.0, 0.0))
                  .isApprox(Eigen::Vector3d(1.5, -1.0, 0.3), 1e-15));
  write_kitti_poses(folder.path() / "b.txt", {{0}, {}, {SE3({1.0, 0.0, 0.0, 0.0}, {0.1, -2.0, 3.0})}});
  EXPECT_EQ(content(folder.path() / "b.txt"), "1 0 0 0.1 0 1 0 -2 0 0 1 3\n");
  write_tum_poses(folder.path() / "c.txt", {{0}, {12.5}, {SE3({-1.0, 0.0, 0.0, 0.0}, {0.1, -2.0, 3.0})}});
  EXPECT_THAT(content(folder.path() / "c.txt"), testing::StartsWith("12.5 0.1 -2 3 "));
  EXPECT_THAT(content(folder.path() / "c.txt"), testing::EndsWith(" 1\n"));
}

TEST(TrajectoryFile, CommentsInTumFilesAreSkipped) {
  const TempFolder folder;
  const PoseList poses = read_trajectory(
      folder.write("tum.txt", "# stamp tx ...\n\n1.5 1 2 3 0 0 0 1\n # end\n2 4 5 6 0 0 1 0\n"));
  EXPECT_EQ(poses.stamps_s, (std::vector<double>{1.5, 2.0}));
  EXPECT_EQ(poses.frames, (std::vector<std::size_t>{0, 1}));
}

TEST(TrajectoryFile, EmptyFilesGiveNoPoses) {
  const TempFolder folder;
  EXPECT_TRUE(read_trajectory(folder.write("empty.txt", "")).T_world_body.empty());
  EXPECT_TRUE(read_trajectory(folder.write("comments.txt", "# nothing\n\n")).T_world_body.empty());
  write_kitti_poses(folder.path() / "none.txt", {});
  EXPECT_TRUE(read_trajectory(folder.path() / "none.txt").T_world_body.empty());
}

TEST(TrajectoryFile, ProblemsNameFileAndLine) {
  const TempFolder folder;
  const std::string good = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const auto problem = [&](const std::string& text) { return message_of(folder.write("bad.txt", text)); };
  EXPECT_THAT(problem(good + "1 0 0 0 0 1 0\n"), testing::HasSubstr("bad.txt:2: 7 numbers"));
  EXPECT_THAT(problem("1 2 3\n"), testing::HasSubstr("bad.txt:1: 3 numbers"));
  EXPECT_THAT(problem(good + "1 0 0 0 0 1 0 nan 0 0 1 0\n"), testing::HasSubstr("bad.txt:2"));
  EXPECT_THAT(problem(good + "1 0 0 x 0 1 0 0 0 0 1 0\n"), testing::HasSubstr("bad.txt:2"));
  EXPECT_THAT(problem("1 0 0 0 0 1 0 0 0 0 2 0\n"),
              testing::HasSubstr("bad.txt:1: no finite pose with a rotation"));
  EXPECT_THAT(problem("1 0 0 0 0 1 0 0 0 0 -1 0\n"),
              testing::HasSubstr("bad.txt:1: no finite pose with a rotation"));
  EXPECT_THAT(problem("0 1 2 3 0 0 0 2\n"),
              testing::HasSubstr("bad.txt:1: no finite pose with a quaternion"));
  EXPECT_THAT(message_of(folder.path() / "absent.txt"), testing::HasSubstr("absent.txt"));
  EXPECT_THROW(write_kitti_poses(folder.path() / "no" / "folder.txt", {}), InputError);
  EXPECT_THROW(write_tum_poses(folder.path() / "tum.txt", {{0}, {}, {SE3()}}), InputError);
}

}  // namespace
}  // namespace mlo
