#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "mlo/core/voxel_grid.hpp"
#include "mlo/perception/features.hpp"
#include "mlo/perception/ground.hpp"
#include "mlo/perception/objects.hpp"
#include "perception/synthetic_scan.hpp"

namespace mlo {
namespace {

/// A street with one of its cars detected, and all that choosing features needs.
class Features : public testing::Test {
 protected:
  const test::Scene scene = test::street(1.73);
  const std::vector<Point> points = test::make_scan(scene).scan.points;
  const std::vector<Detection> detections{{.box = scene.boxes[0]}};
  const std::vector<std::uint8_t> is_ground = segment_ground(points, {}).is_ground;
  const std::vector<std::uint16_t> object_ids = label_objects(points, detections, 0.1);
  const std::vector<PointKind> kinds = correct_mutually(is_ground, object_ids);
  const ScanLines lines = group_lines(points);
  const LineShape shape = measure_lines(points, lines);
  const FeatureConfig config;
  const ChosenPoints chosen =
      choose_points(lines, shape, segment_lines(lines, is_ground, config.segments_per_line), kinds, config);

  /// Line and segment of each point: the points of this scan come line by line.
  std::vector<std::size_t> segment_of_points() const {
    std::vector<std::size_t> result(points.size());
    const auto parts = static_cast<std::size_t>(config.segments_per_line);
    for (std::size_t line = 0; line < lines.num_lines(); ++line) {
      const std::size_t size = lines.begin[line + 1] - lines.begin[line];
      for (std::size_t part = 0; part < parts; ++part) {
        for (std::size_t i = size * part / parts; i < size * (part + 1) / parts; ++i) {
          result[lines.order[lines.begin[line] + i]] = line * parts + part;
        }
      }
    }
    return result;
  }

  std::map<std::size_t, std::vector<std::uint32_t>> by_segment(
      const std::vector<std::uint32_t>& indices) const {
    const std::vector<std::size_t> segment = segment_of_points();
    std::map<std::size_t, std::vector<std::uint32_t>> result;
    for (const std::uint32_t i : indices) result[segment[i]].push_back(i);
    return result;
  }

  void expect_of_kind(const std::vector<std::uint32_t>& indices, PointKind kind) const {
    ASSERT_FALSE(indices.empty());
    for (const std::uint32_t i : indices) {
      EXPECT_EQ(kinds[i], kind);
      EXPECT_EQ(shape.reliable[i], 1);
    }
  }
};

TEST_F(Features, AreOfTheirKindAndReliable) {
  expect_of_kind(chosen.ground, PointKind::ground);
  expect_of_kind(chosen.edges, PointKind::background);
  expect_of_kind(chosen.edge_candidates, PointKind::background);
  expect_of_kind(chosen.surfaces, PointKind::background);
  expect_of_kind(chosen.object_edges, PointKind::object);
}

TEST_F(Features, ComeBestFirstAndAsManyAsConfigured) {
  const auto smoother = [&](std::uint32_t a, std::uint32_t b) {
    return shape.smoothness[a] < shape.smoothness[b];
  };
  for (const auto& [segment, indices] : by_segment(chosen.ground)) {
    EXPECT_LE(indices.size(), static_cast<std::size_t>(config.ground_per_segment));
    EXPECT_TRUE(std::is_sorted(indices.begin(), indices.end(), smoother));
  }
  for (const auto& [segment, indices] : by_segment(chosen.surfaces)) {
    EXPECT_LE(indices.size(), static_cast<std::size_t>(config.surfaces_per_segment));
    EXPECT_TRUE(std::is_sorted(indices.begin(), indices.end(), smoother));
  }
  for (const auto& [segment, indices] : by_segment(chosen.edge_candidates)) {
    EXPECT_LE(indices.size(), static_cast<std::size_t>(config.edge_candidates_per_segment));
    EXPECT_TRUE(std::is_sorted(indices.rbegin(), indices.rend(), smoother));
  }
}

TEST_F(Features, TheBestGroundPointOfEverySegmentIsChosen) {
  const std::vector<std::size_t> segment = segment_of_points();
  std::map<std::size_t, float> flattest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (kinds[i] != PointKind::ground || shape.reliable[i] == 0) continue;
    const auto [known, is_new] = flattest.try_emplace(segment[i], shape.smoothness[i]);
    known->second = std::min(known->second, shape.smoothness[i]);
  }
  // Only a neighbour chosen in the segment before may take the flattest one's place.
  std::size_t agree = 0;
  for (const auto& [s, indices] : by_segment(chosen.ground))
    agree += shape.smoothness[indices[0]] == flattest[s];
  EXPECT_GT(agree, flattest.size() * 9 / 10);
  EXPECT_LE(agree, flattest.size());
}

TEST_F(Features, TheSharpestCandidatesAreTheEdges) {
  const auto candidates = by_segment(chosen.edge_candidates);
  for (const auto& [segment, edges] : by_segment(chosen.edges)) {
    ASSERT_LE(edges.size(), static_cast<std::size_t>(config.edges_per_segment));
    EXPECT_TRUE(std::equal(edges.begin(), edges.end(), candidates.at(segment).begin()));
  }
  for (const std::uint32_t i : chosen.edge_candidates)
    EXPECT_GE(shape.smoothness[i], config.min_edge_smoothness);
  for (const std::uint32_t i : chosen.surfaces) EXPECT_LE(shape.smoothness[i], config.max_surface_smoothness);
}

TEST_F(Features, KeepTheirNeighboursOnTheLineFromBeingChosen) {
  std::vector<std::uint32_t> background = chosen.edge_candidates;
  background.insert(background.end(), chosen.surfaces.begin(), chosen.surfaces.end());
  for (std::vector<std::uint32_t> family : {chosen.ground, background, chosen.object_edges}) {
    std::sort(family.begin(), family.end());
    for (std::size_t k = 1; k < family.size(); ++k) {
      if (points[family[k]].ring != points[family[k - 1]].ring) continue;
      EXPECT_GT(family[k] - family[k - 1], 5U);
    }
  }
}

TEST_F(Features, CandidatesAreOnePerVoxelAndCoverTheirKind) {
  const auto key_of = [](const Eigen::Vector3f& p) {
    const VoxelKey key = voxel_key(p, 1.0F / 0.2F);
    return std::tuple(key.x, key.y, key.z);
  };
  const std::vector<FeaturePoint> candidates = gather_candidates(
      points, shape, kinds, PointKind::background, chosen.edge_candidates, config.candidate_voxel_m);
  std::set<std::tuple<int, int, int>> voxels;
  for (const FeaturePoint& candidate : candidates)
    EXPECT_TRUE(voxels.insert(key_of(candidate.p_lidar)).second);
  const std::set<std::uint32_t> edges(chosen.edge_candidates.begin(), chosen.edge_candidates.end());
  std::set<std::tuple<int, int, int>> expected;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (kinds[i] == PointKind::background && !edges.contains(i)) expected.insert(key_of(points[i].p_lidar));
  }
  EXPECT_EQ(voxels, expected);
}

TEST_F(Features, EdgesStandAtThePole) {
  const Eigen::Vector2f pole(5.0F, -5.0F);
  const auto near_pole = std::count_if(chosen.edges.begin(), chosen.edges.end(), [&](std::uint32_t i) {
    return (points[i].p_lidar.head<2>() - pole).norm() < 0.3F;
  });
  EXPECT_GT(near_pole, 10);
}

TEST(MeanSmoothness, IsTheMean) {
  EXPECT_EQ(mean_smoothness({}), 0.0);
  EXPECT_DOUBLE_EQ(mean_smoothness(std::vector<FeaturePoint>{{.smoothness = 0.25F}, {.smoothness = 0.75F}}),
                   0.5);
}

TEST(ChooseWithoutLines, TakesOnlyPointsOnNoLine) {
  std::vector<FeaturePoint> candidates(3);
  candidates[0].ring = 4;
  candidates[1].p_lidar.x() = 0.5F;
  candidates[2].p_lidar.x() = 0.6F;
  const std::vector<FeaturePoint> features = choose_without_lines(candidates, 1.0);
  ASSERT_EQ(features.size(), 1U);
  EXPECT_EQ(features[0].p_lidar.x(), 0.5F);
}

}  // namespace
}  // namespace mlo
