#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/dataset.hpp"
#include "mlo/io/pose_files.hpp"
#include "real_data.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kDegToRad = std::numbers::pi / 180.0;

SE3 pose(double x, double yaw_rad) {
  return SE3(so3_exp(Eigen::Vector3d(0.0, 0.0, yaw_rad)), Eigen::Vector3d(x, 0.0, 0.0));
}

double distance(const SE3& a, const SE3& b) {
  return (a.inverse() * b).log().norm();
}

std::vector<ScanFile> scans_at(const std::vector<double>& stamps_s) {
  std::vector<ScanFile> scans;
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    scans.push_back({.path = {}, .frame = i, .stamp_s = stamps_s[i], .duration_s = 0.1});
  }
  return scans;
}

TEST(ReadKittiPoses, Rows) {
  const test::TempFolder folder;
  const PoseList poses =
      read_kitti_poses(folder.write("04.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n0 -1 0 5 1 0 0 6 0 0 1 7\n"));
  EXPECT_THAT(poses.frames, ElementsAre(0U, 1U));
  EXPECT_TRUE(poses.stamps_s.empty());
  EXPECT_TRUE(
      (poses.T_world_body[1] * Eigen::Vector3d(1.0, 0.0, 0.0)).isApprox(Eigen::Vector3d(5.0, 7.0, 7.0)));
  EXPECT_TRUE(read_kitti_poses(folder.write("empty.txt", "\n")).frames.empty());
  EXPECT_THAT([&] { read_kitti_poses(folder.write("bad.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 2 3\n")); },
              ThrowsMessage<InputError>(HasSubstr("bad.txt:2: 3 numbers")));
}

TEST(ReadOxtsLines, MercatorNearTheFirstPlaceIsMetric) {
  const test::TempFolder folder;
  // One thousandth of a degree north, then the same east, at latitude 49; a yaw of 90 degrees looks north.
  const PoseList poses = read_oxts_lines(
      folder.write("0000.txt", "49 8 110 0 0 0\n49.001 8 111 0 0 0\n49 8.001 110 0 0 1.5707963267948966\n"));
  const double arc_m = 6378137.0 * 0.001 * kDegToRad;
  EXPECT_TRUE(poses.T_world_body[0].translation().isZero());
  EXPECT_NEAR(poses.T_world_body[1].translation().y(), arc_m, 0.002);
  EXPECT_NEAR(poses.T_world_body[1].translation().z(), 1.0, 1e-9);
  EXPECT_NEAR(poses.T_world_body[2].translation().x(), arc_m * std::cos(49.0 * kDegToRad), 1e-6);
  EXPECT_TRUE(
      (poses.T_world_body[2].rotation() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_THAT([&] { read_oxts_lines(folder.write("bad.txt", "49 8 110\n")); },
              ThrowsMessage<InputError>(HasSubstr("bad.txt:1: 3 numbers")));
}

TEST(ReadOxtsFolder, FramesAndStampsWithAGap) {
  const test::TempFolder folder;
  folder.write("data/0000000000.txt", "49 8 110 0 0 0\n");
  folder.write("data/0000000002.txt", "49 8 110 0 0 0.5\n");
  EXPECT_TRUE(read_oxts_folder(folder.path()).stamps_s.empty());
  folder.write("timestamps.txt", "0.0\n0.1\n0.2\n");
  const PoseList poses = read_oxts_folder(folder.path());
  EXPECT_THAT(poses.frames, ElementsAre(0U, 2U));
  EXPECT_THAT(poses.stamps_s, ElementsAre(0.0, 0.2));
}

TEST(PosesAt, InterpolatesWhereBothHaveStamps) {
  const PoseList poses{{0, 1, 2}, {1.0, 1.1, 1.2}, {pose(0.0, 0.0), pose(1.0, 0.0), pose(3.0, 0.0)}};
  const PoseList at = poses_at(scans_at({0.8, 0.95, 1.05, 1.1, 1.15, 1.25, 1.4}), poses);
  EXPECT_THAT(at.frames, ElementsAre(1U, 2U, 3U, 4U, 5U));  // 0.8 and 1.4 are more than a sweep away
  std::vector<double> x;
  for (const SE3& T : at.T_world_body) x.push_back(T.translation().x());
  using testing::DoubleNear;
  EXPECT_THAT(x, ElementsAre(DoubleNear(-0.5, 1e-12), DoubleNear(0.5, 1e-12), DoubleNear(1.0, 1e-12),
                             DoubleNear(2.0, 1e-12), DoubleNear(4.0, 1e-12)));
}

TEST(PosesAt, EqualAndFallingStampsAreLeftOut) {
  const PoseList poses{
      {0, 1, 2, 3}, {1.0, 1.0, 0.9, 1.1}, {pose(0.0, 0.0), pose(7.0, 0.0), pose(8.0, 0.0), pose(1.0, 0.0)}};
  const PoseList at = poses_at(scans_at({1.05}), poses);
  ASSERT_EQ(at.frames.size(), 1U);
  EXPECT_NEAR(at.T_world_body[0].translation().x(), 0.5, 1e-12);
}

TEST(PosesAt, ByFrameWithoutStamps) {
  const PoseList poses{{0, 2, 9}, {}, {pose(0.0, 0.0), pose(2.0, 0.0), pose(9.0, 0.0)}};
  const PoseList at = poses_at(scans_at({0.0, 0.1, 0.2, 0.3}), poses);
  EXPECT_THAT(at.frames, ElementsAre(0U, 2U));
  EXPECT_THAT(at.stamps_s, ElementsAre(0.0, 0.2));
  EXPECT_EQ(at.T_world_body[1].translation().x(), 2.0);
  EXPECT_TRUE(poses_at({}, poses).frames.empty());
  EXPECT_TRUE(poses_at(scans_at({0.0}), PoseList{}).frames.empty());
}

TEST(Rebased, StartsAtTheIdentityAndKeepsTheMotion) {
  const SE3 T_body_other = SE3::exp((SE3::Tangent() << 0.3, -0.1, 0.5, 0.2, 0.4, -1.0).finished());
  const PoseList poses{{0, 1}, {}, {pose(3.0, 0.4), pose(5.0, 0.7)}};
  const PoseList other = rebased(poses, T_body_other);
  EXPECT_LT(distance(other.T_world_body[0], SE3()), 1e-12);
  const SE3 body_motion = poses.T_world_body[0].inverse() * poses.T_world_body[1];
  EXPECT_LT(distance(T_body_other * other.T_world_body[1] * T_body_other.inverse(), body_motion), 1e-12);
  EXPECT_TRUE(rebased(PoseList{}, T_body_other).frames.empty());
}

TEST(LidarTruth, SaysWhatItLacks) {
  std::vector<std::string> warnings;
  const PoseList poses{{0, 1}, {}, {pose(0.0, 0.0), pose(1.0, 0.0)}};
  EXPECT_FALSE(lidar_truth(scans_at({0.0, 0.1}), poses, std::nullopt, "oxts", warnings).has_value());
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("calibration")));
  warnings.clear();
  const auto truth = lidar_truth(scans_at({0.0, 0.1, 0.2}), poses, SE3(), "poses.txt", warnings);
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("poses for 2 of 3 scans")));
  ASSERT_TRUE(truth.has_value());
  EXPECT_THAT(truth->frames, ElementsAre(0U, 1U));
}

// Motion of the lidar from scan to scan: mean and largest deviation [m] from a list of poses.
std::pair<double, double> motion_deviation_m(const PoseList& truth, const PoseList& reference) {
  double sum = 0.0;
  double largest = 0.0;
  for (std::size_t i = 1; i < truth.frames.size(); ++i) {
    const SE3 motion = truth.T_world_body[i - 1].inverse() * truth.T_world_body[i];
    const SE3 expected =
        reference.T_world_body[truth.frames[i] - 1].inverse() * reference.T_world_body[truth.frames[i]];
    const double deviation = (motion.inverse() * expected).translation().norm();
    sum += deviation;
    largest = std::max(largest, deviation);
  }
  return {sum / static_cast<double>(truth.frames.size() - 1), largest};
}

TEST(RealTruth, OfOdometryEqualsTheLidarPoses) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  for (const std::string sequence : {"01", "04"}) {
    const Dataset dataset = open_dataset(*data / "kitti_odometry", {.sequence = sequence});
    ASSERT_TRUE(dataset.truth.has_value());
    ASSERT_EQ(dataset.truth->frames.size(), dataset.scans->size());
    const PoseList reference = read_kitti_poses(*data / "truth_lidar" / (sequence + ".txt"));
    for (std::size_t i = 0; i < dataset.scans->size(); ++i) {
      ASSERT_LT(distance(dataset.truth->T_world_body[i], reference.T_world_body[i]), 1e-4)
          << sequence << ' ' << i;
    }
  }
}

TEST(RealTruth, OfRawAgreesWithIntegratedVelocity) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << test::kNoRealData;
  for (const std::string drive : {"0005", "0009"}) {
    const Dataset dataset = open_dataset(*data / "kitti_raw", {.sequence = drive});
    ASSERT_TRUE(dataset.truth.has_value());
    ASSERT_EQ(dataset.truth->frames.size(), dataset.scans->size());
    const PoseList reference = read_kitti_poses(*data / "truth_lidar" / (drive + "_vel.txt"));
    const auto [mean_m, largest_m] = motion_deviation_m(*dataset.truth, reference);
    RecordProperty("mean_m_" + drive, std::to_string(mean_m));
    EXPECT_LT(mean_m, 0.03) << drive;  // noise of the oxts positions
    EXPECT_LT(largest_m, 0.2) << drive;
  }
}

}  // namespace
}  // namespace mlo
