#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mlo/loops/loop_search.hpp"

namespace mlo {
namespace {

/// What a place looks like: pillars at distances that only this place has.
PlaceDescriptor place(int number) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 60; ++i) {
    const float azimuth = 0.05F + 0.10471976F * static_cast<float>(i);
    const float range = 6.0F + 4.0F * static_cast<float>((i * (2 * number + 3) + number * number) % 17);
    points.push_back({range * std::cos(azimuth), range * std::sin(azimuth), 1.0F});
  }
  return PlaceDescriptor(points);
}

/// A keyframe each 10 m around a square of 100 m, and the first three places again with some drift.
std::vector<Keyframe> round_trip(const Eigen::Vector3d& drift_m) {
  std::vector<Keyframe> keyframes;
  for (int i = 0; i < 43; ++i) {
    const int side = (i / 10) % 4;
    const double along = 10.0 * (i % 10);
    const std::array<Eigen::Vector3d, 4> corners{{{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}}};
    const std::array<Eigen::Vector3d, 4> ahead{{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}};
    const auto k = static_cast<std::size_t>(side);
    const Eigen::Vector3d position =
        corners[k] + along * ahead[k] + (i >= 40 ? drift_m : Eigen::Vector3d::Zero());
    keyframes.push_back({.scan = static_cast<std::size_t>(10 * i),
                         .way_m = 10.0 * i,
                         .T_map_lidar = SE3(Eigen::Quaterniond::Identity(), position),
                         .place = place(i % 40)});
  }
  return keyframes;
}

TEST(LoopSearch, PlacesThatAreSeenAgainAreCandidates) {
  const std::vector<LoopCandidate> candidates = find_loop_candidates(round_trip({5.0, -6.0, 1.0}), {});
  ASSERT_EQ(candidates.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(candidates[i].earlier, i);
    EXPECT_EQ(candidates[i].later, 40 + i);
    EXPECT_NEAR(candidates[i].yaw_rad, 0.0, 1e-9);
  }
}

TEST(LoopSearch, NotWhereNoDriftCanReach) {
  EXPECT_TRUE(find_loop_candidates(round_trip({50.0, 0.0, 0.0}), {}).empty());
}

TEST(LoopSearch, ShortWaysAreNoLoops) {
  EXPECT_TRUE(find_loop_candidates(round_trip({0.0, 0.0, 0.0}), {.min_way_m = 500.0}).empty());
}

TEST(LoopSearch, LoopsThatNothingAgreesWithAreLeftOut) {
  const std::vector<Keyframe> keyframes = round_trip({1.0, 2.0, 0.0});
  const SE3 shift(Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0});
  const SE3 far(Eigen::Quaterniond::Identity(), {3.0, 0.0, 0.0});
  const std::vector<Loop> loops{{.earlier = 0, .later = 40, .T_earlier_later = {}},
                                {.earlier = 1, .later = 41, .T_earlier_later = shift},
                                {.earlier = 2, .later = 42, .T_earlier_later = far}};
  const std::vector<Loop> kept = agreeing_loops(loops, keyframes);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].later, 40U);
  EXPECT_EQ(kept[1].later, 41U);
  EXPECT_TRUE(agreeing_loops({loops.data(), 1}, keyframes).empty());
}

}  // namespace
}  // namespace mlo
