#include <cmath>
#include <numeric>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/perception/scan_lines.hpp"

namespace mlo {
namespace {

using testing::ElementsAre;

Point on_ring(std::uint16_t ring, const Eigen::Vector3f& p = Eigen::Vector3f::Zero()) {
  Point point;
  point.p_lidar = p;
  point.ring = ring;
  return point;
}

/// One line of ranges, a point every 0.2 degrees.
std::vector<Point> line_of_ranges(const std::vector<float>& ranges) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const float azimuth = 0.0035F * static_cast<float>(i);
    points.push_back(on_ring(0, ranges[i] * Eigen::Vector3f(std::cos(azimuth), std::sin(azimuth), 0.0F)));
  }
  return points;
}

TEST(GroupLines, KeepsTheOrderWithinARingAndLeavesOutPointsWithoutOne) {
  const std::vector<Point> points{on_ring(2), on_ring(0), on_ring(Point::kNoRing), on_ring(2), on_ring(0)};
  const ScanLines lines = group_lines(points);
  EXPECT_THAT(lines.order, ElementsAre(1, 4, 0, 3));
  EXPECT_THAT(lines.begin, ElementsAre(0, 2, 2, 4));
}

TEST(GroupLines, OfNothing) {
  EXPECT_EQ(group_lines({}).num_lines(), 0U);
  EXPECT_EQ(group_lines(std::vector<Point>(3)).num_lines(), 0U);
}

TEST(MeasureLines, SmoothnessIsThatOfLoam) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  std::vector<Point> points;
  for (const std::uint16_t ring : {0, 1, 2}) {
    const int size = ring == 1 ? 4 : 200;  // also a line shorter than the neighbourhood
    for (int i = 0; i < size; ++i) {
      const Eigen::Vector3f jitter(uniform(random), uniform(random), uniform(random));
      points.push_back(on_ring(ring, Eigen::Vector3f(10.0F, 0.05F * static_cast<float>(i), 0.0F) + jitter));
    }
  }
  const ScanLines lines = group_lines(points);
  const LineShape shape = measure_lines(points, lines);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double neighbours = 0.0;
    for (std::size_t j = i < 5 ? 0 : i - 5; j <= std::min(i + 5, points.size() - 1); ++j) {
      if (j == i || points[j].ring != points[i].ring) continue;
      sum += (points[i].p_lidar - points[j].p_lidar).cast<double>();
      neighbours += 1.0;
    }
    const double c = sum.norm() / (neighbours * points[i].p_lidar.cast<double>().norm());
    EXPECT_NEAR(shape.smoothness[i], c, 1e-5) << i;
    EXPECT_TRUE(neighbours == 10.0 || shape.reliable[i] == 0) << i;
  }
}

TEST(MeasureLines, TheHiddenBorderOfTheFartherSurfaceIsUnreliable) {
  std::vector<float> ranges(60, 20.0F);
  std::fill(ranges.begin() + 25, ranges.begin() + 37, 8.0F);  // something in front of a wall
  const LineShape shape = measure_lines(line_of_ranges(ranges), group_lines(line_of_ranges(ranges)));
  for (std::size_t i = 5; i < 55; ++i) {
    const bool hidden = (i >= 19 && i < 25) || (i >= 37 && i < 43);
    EXPECT_EQ(shape.reliable[i], hidden ? 0 : 1) << i;
  }
}

TEST(MeasureLines, ASurfaceAlongTheBeamIsUnreliable) {
  std::vector<float> ranges;
  for (int i = 0; i < 40; ++i) ranges.push_back(10.0F + 0.25F * static_cast<float>(i));
  const LineShape shape = measure_lines(line_of_ranges(ranges), group_lines(line_of_ranges(ranges)));
  EXPECT_EQ(std::accumulate(shape.reliable.begin(), shape.reliable.begin() + 20, 0), 0);
}

TEST(MeasureLines, PointsOnNoLineAreFlatAndUnreliable) {
  std::vector<Point> points(20);
  const LineShape shape = measure_lines(points, group_lines(points));
  EXPECT_EQ(shape.smoothness, std::vector<float>(20, 0.0F));
  EXPECT_EQ(shape.reliable, std::vector<std::uint8_t>(20, 0));
}

TEST(MeasureLines, PointsAtTheOriginAreUnreliableButFinite) {
  const std::vector<Point> points(30, on_ring(0));
  const LineShape shape = measure_lines(points, group_lines(points));
  EXPECT_EQ(shape.smoothness, std::vector<float>(30, 0.0F));
  EXPECT_EQ(shape.reliable, std::vector<std::uint8_t>(30, 0));
}

TEST(SegmentLines, ListsHeadsAndTailsOfRuns) {
  const std::vector<Point> points(8, on_ring(0));
  const std::vector<std::uint8_t> is_ground{1, 1, 0, 1, 1, 1, 0, 0};
  const SegmentedLines segments = segment_lines(group_lines(points), is_ground, 2);
  const auto pairs = [](std::span<const PointRun> runs) {
    std::vector<std::pair<unsigned, unsigned>> result;
    for (const PointRun& run : runs) result.emplace_back(run.head, run.tail);
    return result;
  };
  EXPECT_THAT(pairs(segments.ground.segment(0)), ElementsAre(std::pair(0, 1), std::pair(3, 3)));
  EXPECT_THAT(pairs(segments.ground.segment(1)), ElementsAre(std::pair(4, 5)));
  EXPECT_THAT(pairs(segments.background.segment(0)), ElementsAre(std::pair(2, 2)));
  EXPECT_THAT(pairs(segments.background.segment(1)), ElementsAre(std::pair(6, 7)));
}

TEST(SegmentLines, RunsOfBothKindsHoldEveryPlaceOnce) {
  std::mt19937 random(2);
  std::vector<Point> points;
  std::vector<std::uint8_t> is_ground;
  for (int i = 0; i < 1000; ++i) {
    points.push_back(on_ring(static_cast<std::uint16_t>(random() % 7)));
    is_ground.push_back(static_cast<std::uint8_t>(random() % 2));
  }
  const ScanLines lines = group_lines(points);
  const SegmentedLines segments = segment_lines(lines, is_ground, 6);
  EXPECT_EQ(segments.ground.num_segments(), 42U);
  std::vector<int> seen(points.size(), 0);
  for (const std::uint8_t kind : {0, 1}) {
    for (const PointRun& run : (kind == 1 ? segments.ground : segments.background).runs) {
      for (std::uint32_t place = run.head; place <= run.tail; ++place) {
        ++seen[place];
        EXPECT_EQ(is_ground[lines.order[place]], kind);
      }
    }
  }
  EXPECT_EQ(seen, std::vector<int>(points.size(), 1));
}

TEST(SegmentLines, OfNothing) {
  EXPECT_EQ(segment_lines({}, {}, 6).ground.num_segments(), 0U);
}

}  // namespace
}  // namespace mlo
