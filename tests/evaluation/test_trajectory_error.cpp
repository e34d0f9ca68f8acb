#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "mlo/evaluation/trajectory_error.hpp"

namespace mlo {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

struct Poses {
  std::vector<std::size_t> frames;
  std::vector<double> stamps_s;
  std::vector<SE3> T_world_body;

  TrajectoryView view() const { return {frames, stamps_s, T_world_body}; }
};

Poses numbered(std::vector<SE3> T_world_body) {
  Poses poses{std::vector<std::size_t>(T_world_body.size()), {}, std::move(T_world_body)};
  std::iota(poses.frames.begin(), poses.frames.end(), 0U);
  return poses;
}

SE3 yaw_deg(double angle_deg, const Eigen::Vector3d& translation_m) {
  return {so3_exp({0.0, 0.0, angle_deg / kDegPerRad}), translation_m};
}

// A winding path that also climbs, one pose every step_m.
Poses winding(std::size_t count, double step_m) {
  std::vector<SE3> poses{SE3()};
  for (std::size_t i = 1; i < count; ++i) {
    SE3::Tangent xi;
    xi << step_m, 0.0, 0.0, 0.0, 0.01 * std::sin(0.1 * static_cast<double>(i)),
        0.03 * std::cos(0.05 * static_cast<double>(i));
    poses.push_back(poses.back() * SE3::exp(xi));
  }
  return numbered(poses);
}

TrajectoryErrors errors_of(const Poses& truth, const Poses& estimate,
                           const TrajectoryErrorOptions& options = {}) {
  return trajectory_errors(match_poses(truth.view(), estimate.view(), MatchBy::frame), options);
}

TEST(TrajectoryError, RigidlyMovedTruthHasNoError) {
  const Poses truth = winding(400, 1.0);
  Poses estimate = truth;
  SE3::Tangent xi;
  xi << 100.0, -50.0, 3.0, 0.4, -1.0, 2.0;
  for (SE3& pose : estimate.T_world_body) pose = SE3::exp(xi) * pose;
  const TrajectoryErrors errors = errors_of(truth, estimate);
  EXPECT_LT(errors.ate_m.value(), 1e-10);
  EXPECT_LT(errors.rte_m_per_frame.value(), 1e-10);
  EXPECT_LT(errors.rre_deg_per_frame.value(), 1e-10);
  EXPECT_LT(errors.end_point_error_m.value(), 1e-9);
  EXPECT_TRUE(errors.T_truth_estimate.matrix().isApprox(SE3::exp(xi).inverse().matrix(), 1e-9));
  EXPECT_GT(errors.segments.count, 0U);
  EXPECT_LT(errors.segments.translation_percent, 1e-9);
  EXPECT_LT(errors.segments.rotation_deg_per_m, 1e-9);
  EXPECT_NEAR(errors.truth_path_m, 399.0, 0.1);
  EXPECT_NEAR(errors.estimate_path_m, errors.truth_path_m, 1e-9);
}

TEST(TrajectoryError, AlignmentIsNotAllowedToScaleOrMirror) {
  // Corners of a square of side 2 about the origin, and the same square half as large: each corner is
  // sqrt(2)/2 off.
  const std::vector<Eigen::Vector3d> corners{{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}};
  std::vector<SE3> truth;
  std::vector<SE3> half;
  for (const Eigen::Vector3d& corner : corners) {
    truth.push_back(SE3({1, 0, 0, 0}, corner));
    half.push_back(SE3({1, 0, 0, 0}, 0.5 * corner));
  }
  EXPECT_NEAR(errors_of(numbered(truth), numbered(half)).ate_m.value(), std::sqrt(0.5), 1e-12);

  // A mirrored tetrahedron cannot be rotated onto the original.
  std::vector<SE3> tetrahedron;
  std::vector<SE3> mirrored;
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0),
                                   Eigen::Vector3d(0, 2, 0), Eigen::Vector3d(0, 0, 3)}) {
    tetrahedron.push_back(SE3({1, 0, 0, 0}, p));
    mirrored.push_back(SE3({1, 0, 0, 0}, {-p.x(), p.y(), p.z()}));
  }
  const TrajectoryErrors errors = errors_of(numbered(tetrahedron), numbered(mirrored));
  EXPECT_GT(errors.ate_m.value(), 0.1);
  EXPECT_NEAR(errors.T_truth_estimate.matrix().determinant(), 1.0, 1e-12);
}

TEST(TrajectoryError, AlignmentIsTheBestOfManyTried) {
  const Poses truth = winding(40, 1.0);
  Poses estimate = truth;
  std::mt19937 rng(3);
  std::normal_distribution<double> noise(0.0, 0.3);
  for (SE3& pose : estimate.T_world_body)
    pose = SE3({1, 0, 0, 0}, {noise(rng), noise(rng), noise(rng)}) * pose;
  const auto rmse = [&](const SE3& T) {
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.T_world_body.size(); ++i) {
      sum += (truth.T_world_body[i].translation() - T * estimate.T_world_body[i].translation()).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(truth.T_world_body.size()));
  };
  const TrajectoryErrors errors = errors_of(truth, estimate);
  EXPECT_NEAR(rmse(errors.T_truth_estimate), errors.ate_m.value(), 1e-12);
  for (int i = 0; i < 200; ++i) {
    SE3::Tangent xi;
    for (int k = 0; k < 6; ++k) xi(k) = 0.1 * noise(rng);
    EXPECT_GE(rmse(SE3::exp(xi) * errors.T_truth_estimate), errors.ate_m.value() - 1e-12);
  }
}

TEST(TrajectoryError, StepErrorsOfAKnownDamage) {
  // Ten steps of 1 m ahead; the sixth turns by 3 degrees too much, the eighth is 0.2 m too long.
  std::vector<SE3> truth{SE3()};
  std::vector<SE3> estimate{SE3()};
  for (int i = 1; i <= 10; ++i) {
    truth.push_back(truth.back() * yaw_deg(0.0, {1.0, 0.0, 0.0}));
    estimate.push_back(estimate.back() * yaw_deg(i == 6 ? 3.0 : 0.0, {i == 8 ? 1.2 : 1.0, 0.0, 0.0}));
  }
  const TrajectoryErrors errors = errors_of(numbered(truth), numbered(estimate));
  ASSERT_EQ(errors.steps.size(), 10U);
  EXPECT_NEAR(errors.rte_m_per_frame.value(), 0.2 / 10.0, 1e-12);
  EXPECT_NEAR(errors.rre_deg_per_frame.value(), 3.0 / 10.0, 1e-9);
  EXPECT_NEAR(errors.steps[5].rotation_deg, 3.0, 1e-9);
  EXPECT_EQ(errors.steps[5].frame, 6U);
  EXPECT_NEAR(errors.steps[7].translation_m, 0.2, 1e-12);
  // After the turn 4.2 m are left, of which the truth has 4: law of cosines.
  const double expected_m = std::sqrt(4.0 * 4.0 + 4.2 * 4.2 - 2.0 * 4.0 * 4.2 * std::cos(3.0 / kDegPerRad));
  EXPECT_NEAR(errors.end_point_error_m.value(), expected_m, 1e-9);
  EXPECT_NEAR(errors.estimate_path_m, 10.2, 1e-9);
}

TEST(TrajectoryError, MissingFramesDivideTheStepAcrossThem) {
  std::vector<SE3> truth{SE3()};
  for (int i = 1; i <= 6; ++i) truth.push_back(yaw_deg(0.0, {static_cast<double>(i), 0.0, 0.0}));
  Poses estimate{{0, 1, 5, 6}, {}, {}};
  for (const double x : {0.0, 1.0, 5.4, 6.4}) estimate.T_world_body.push_back(yaw_deg(0.0, {x, 0.0, 0.0}));
  const TrajectoryErrors errors = errors_of(numbered(truth), estimate);
  ASSERT_EQ(errors.steps.size(), 3U);
  EXPECT_NEAR(errors.steps[1].translation_m, 0.1, 1e-12);
}

TEST(TrajectoryError, SegmentsOfAScaledStraightPath) {
  // 1 m steps at 10 Hz; the estimate is 2 % too long. A segment ends at the first pose beyond its length.
  std::vector<SE3> truth;
  std::vector<SE3> estimate;
  for (int i = 0; i <= 350; ++i) {
    truth.push_back(yaw_deg(0.0, {static_cast<double>(i), 0.0, 0.0}));
    estimate.push_back(yaw_deg(0.0, {1.02 * static_cast<double>(i), 0.0, 0.0}));
  }
  const TrajectoryErrors errors = errors_of(numbered(truth), numbered(estimate));
  ASSERT_EQ(errors.by_length.size(), 8U);
  EXPECT_EQ(errors.by_length[0].errors.count, 25U);  // starts 0, 10, ..., 240 reach 101 m further
  EXPECT_EQ(errors.by_length[1].errors.count, 15U);
  EXPECT_EQ(errors.by_length[2].errors.count, 5U);
  EXPECT_EQ(errors.by_length[3].errors.count, 0U);
  EXPECT_EQ(errors.segments.count, 45U);
  EXPECT_NEAR(errors.by_length[0].errors.translation_percent, 100.0 * 0.02 * 101.0 / 100.0, 1e-9);
  EXPECT_NEAR(errors.by_length[2].errors.translation_percent, 100.0 * 0.02 * 301.0 / 300.0, 1e-9);
  EXPECT_NEAR(errors.segments.rotation_deg_per_m, 0.0, 1e-12);
  // About 9.8 m/s: within 2 m/s of 8 and of 10 only.
  ASSERT_EQ(errors.by_speed.size(), 2U);
  EXPECT_EQ(errors.by_speed[0].value, 8.0);
  EXPECT_EQ(errors.by_speed[1].value, 10.0);
  EXPECT_EQ(errors.by_speed[1].errors.count, 45U);
}

TEST(TrajectoryError, RotationErrorOfSegmentsIsPerMetre) {
  std::vector<SE3> truth;
  std::vector<SE3> estimate;
  for (int i = 0; i <= 200; ++i) {
    truth.push_back(yaw_deg(0.0, {0.5 * i, 0.0, 0.0}));
    estimate.push_back(yaw_deg(0.01 * i, {0.5 * i, 0.0, 0.0}));
  }
  const TrajectoryErrors errors =
      errors_of(numbered(truth), numbered(estimate), {.segment_lengths_m = {10.0}});
  EXPECT_NEAR(errors.segments.rotation_deg_per_m, 0.01 * 21.0 / 10.0, 1e-9);
}

TEST(TrajectoryError, MatchesALongTruthByFrame) {
  const Poses truth = winding(1101, 1.2);
  Poses estimate = truth;
  estimate.frames.resize(77);
  estimate.T_world_body.resize(77);
  const PoseMatching matching = match_poses(truth.view(), estimate.view(), MatchBy::frame);
  EXPECT_EQ(matching.pairs.size(), 77U);
  EXPECT_EQ(matching.unmatched_truth, 1024U);
  EXPECT_EQ(matching.unmatched_estimate, 0U);
  EXPECT_LT(trajectory_errors(matching).ate_m.value(), 1e-12);
}

TEST(TrajectoryError, MatchesByNearestTimeWithinTheTolerance) {
  Poses truth = winding(5, 1.0);
  truth.stamps_s = {0.0, 0.1, 0.2, 0.3, 0.4};
  Poses estimate = winding(5, 1.0);
  estimate.stamps_s = {0.101, 0.205, 0.209, 0.35, std::numeric_limits<double>::quiet_NaN()};
  const PoseMatching matching = match_poses(truth.view(), estimate.view(), MatchBy::time, 0.02);
  ASSERT_EQ(matching.pairs.size(), 2U);
  EXPECT_EQ(matching.pairs[0].time_s, 0.1);
  EXPECT_EQ(matching.pairs[1].time_s, 0.2);
  EXPECT_EQ(matching.pairs[1].frame, 1U);  // the third would be nearest to the same truth
  EXPECT_EQ(matching.unmatched_truth, 3U);
  EXPECT_EQ(matching.unmatched_estimate, 3U);
}

TEST(TrajectoryError, PosesThatAreNotFiniteStayUnmatched) {
  const Poses truth = winding(10, 1.0);
  Poses estimate = truth;
  estimate.T_world_body[4] = SE3({1, 0, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  const PoseMatching matching = match_poses(truth.view(), estimate.view(), MatchBy::frame);
  EXPECT_EQ(matching.unmatched_estimate, 1U);
  const TrajectoryErrors errors = trajectory_errors(matching);
  EXPECT_EQ(errors.steps.size(), 8U);
  EXPECT_LT(errors.rte_m_per_frame.value(), 1e-12);
}

TEST(TrajectoryError, NothingOnePoseTwoPoses) {
  const Poses truth = winding(10, 1.0);
  Poses estimate = winding(2, 1.5);
  for (const MatchBy by : {MatchBy::frame, MatchBy::time}) {
    const TrajectoryErrors none = trajectory_errors(match_poses(truth.view(), {}, by));
    EXPECT_EQ(none.num_pairs, 0U);
    EXPECT_FALSE(none.ate_m || none.rte_m_per_frame || none.rre_deg_per_frame || none.end_point_error_m);
    EXPECT_EQ(none.truth_path_m, 0.0);
  }
  EXPECT_TRUE(match_poses(truth.view(), estimate.view(), MatchBy::time).pairs.empty());  // no stamps

  const TrajectoryErrors two = errors_of(truth, estimate);
  EXPECT_NEAR(two.rte_m_per_frame.value(), 0.5, 1e-3);
  EXPECT_NEAR(two.ate_m.value(), 0.25, 1e-3);
  EXPECT_EQ(two.segments.count, 0U);

  estimate.frames.resize(1);
  estimate.T_world_body.resize(1);
  const TrajectoryErrors one = errors_of(truth, estimate);
  EXPECT_EQ(one.ate_m.value(), 0.0);
  EXPECT_FALSE(one.rte_m_per_frame || one.end_point_error_m);
}

}  // namespace
}  // namespace mlo
