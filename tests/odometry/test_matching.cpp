#include <gmock/gmock.h>

#include "mlo/odometry/matching.hpp"

namespace mlo {
namespace {

FeaturePoint at(double x, double y, double z, std::uint16_t ring) {
  FeaturePoint point;
  point.p_lidar = Eigen::Vector3d(x, y, z).cast<float>();
  point.ring = ring;
  return point;
}

CandidateSet candidates(const std::vector<FeaturePoint>& points) {
  return {points, SweepMotion::none(), 1000};
}

TEST(FindLine, JoinsTwoScanLines) {
  const CandidateSet post =
      candidates({at(5, 0, 0.0, 3), at(5, 0.3, 0.02, 3), at(5, 0, 0.5, 2), at(5, 0, -0.6, 4)});
  const std::optional<Line> line = find_line({5.1, 0.0, 0.1}, post, 1.0, {});
  ASSERT_TRUE(line);
  EXPECT_NEAR((line->across.transpose() * Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-6);
  EXPECT_NEAR(point_to_line({5.1, 0.0, 0.1}, *line).value.norm(), 0.1, 1e-6);
}

TEST(FindLine, NeedsAnotherScanLineWithinTheGap) {
  OdometryConfig config;
  config.max_ring_gap = 2;
  EXPECT_FALSE(find_line({5, 0, 0}, candidates({at(5, 0, 0, 3), at(5, 0, 0.5, 3)}), 1.0, config));
  EXPECT_FALSE(find_line({5, 0, 0}, candidates({at(5, 0, 0, 3), at(5, 0, 0.5, 6)}), 1.0, config));
  EXPECT_TRUE(find_line({5, 0, 0}, candidates({at(5, 0, 0, 3), at(5, 0, 0.5, 5)}), 1.0, config));
}

TEST(FindLine, KeepsTheGateAndTheBaseline) {
  const CandidateSet near_pair = candidates({at(5, 0, 0, 3), at(5, 0, 0.01, 2)});
  EXPECT_FALSE(find_line({5, 0, 0}, near_pair, 1.0, {}));
  const CandidateSet pair = candidates({at(5, 0, 0, 3), at(5, 0, 0.5, 2)});
  EXPECT_FALSE(find_line({6, 0, 0}, pair, 0.5, {}));
  EXPECT_TRUE(find_line({6, 0, 0}, pair, 1.5, {}));
}

TEST(FindPlane, TakesTwoPointsOfOneScanLineAndOneOfAnother) {
  const CandidateSet wall =
      candidates({at(5, 0, 0, 3), at(5, 0.4, 0, 3), at(5, 0.8, 0, 3), at(5, 0.1, 0.5, 2)});
  const std::optional<Plane> plane = find_plane({5.2, 0.05, 0.1}, wall, 1.0, {});
  ASSERT_TRUE(plane);
  EXPECT_NEAR(std::abs(plane->normal.x()), 1.0, 1e-6);
  EXPECT_NEAR(std::abs(point_to_plane({5.2, 0.0, 0.1}, *plane).value(0)), 0.2, 1e-6);
}

TEST(FindPlane, MakesNoDegenerateTriangles) {
  EXPECT_FALSE(find_plane({5, 0, 0}, candidates({at(5, 0, 0, 3), at(5, 0.4, 0, 3)}), 1.0, {}));
  const CandidateSet in_line = candidates({at(5, 0, 0, 3), at(5, 0.4, 0, 3), at(5, 0.8, 0, 2)});
  EXPECT_FALSE(find_plane({5, 0, 0}, in_line, 1.0, {}));
}

TEST(FindShapes, DoWithoutRings) {
  constexpr std::uint16_t kNone = Point::kNoRing;
  const CandidateSet wall =
      candidates({at(5, 0, 0, kNone), at(5, 0.4, 0, kNone), at(5, 0.8, 0, kNone), at(5, 0.1, 0.5, kNone)});
  const std::optional<Plane> plane = find_plane({5.2, 0.05, 0.1}, wall, 1.0, {});
  ASSERT_TRUE(plane);
  EXPECT_NEAR(std::abs(plane->normal.x()), 1.0, 1e-6);
  const std::optional<Line> line = find_line({5.2, 0.05, 0.1}, wall, 1.0, {});
  ASSERT_TRUE(line);
  EXPECT_NEAR((line->across.transpose() * Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-6);
}

TEST(MatchLines, ComeInTheOrderOfFeatures) {
  const CandidateSet post = candidates({at(5, 0, 0, 3), at(5, 0, 0.5, 2)});
  const std::vector<FeaturePoint> features = {at(5, 0, 0.1, 3), at(50, 0, 0, 3), at(NAN, 0, 0, 3),
                                              at(5, 0, 0.2, 2)};
  const Placement placement(SE3(), {.motion_compensated = true});
  const std::vector<LineMatch> matches = match_lines(features, placement, post, 1.0, {});
  ASSERT_EQ(matches.size(), 2U);
  EXPECT_EQ(matches[0].feature, 0U);
  EXPECT_EQ(matches[1].feature, 3U);
  EXPECT_TRUE(match_planes(features, placement, post, 1.0, {}).empty());
  EXPECT_TRUE(match_lines({}, placement, post, 1.0, {}).empty());
}

}  // namespace
}  // namespace mlo
