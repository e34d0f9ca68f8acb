#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "mlo/evaluation/map_removal.hpp"

namespace mlo {
namespace {

using Labelled = std::vector<LabelledPoint>;
using Points = std::vector<Eigen::Vector3f>;

// A point in the middle of the i-th voxel of 0.2 m along x.
Eigen::Vector3f in_voxel(int i) {
  return {0.2F * static_cast<float>(i) + 0.1F, 0.1F, 0.1F};
}

// Voxels 0 to 7 at rest, 10 to 13 moving, a point in each.
Labelled street() {
  Labelled points;
  for (int i = 0; i < 8; ++i) points.push_back({in_voxel(i), Mobility::at_rest});
  for (int i = 10; i < 14; ++i) points.push_back({in_voxel(i), Mobility::moving});
  return points;
}

Points without_labels(const Labelled& labelled, Mobility wanted) {
  Points points;
  for (const LabelledPoint& point : labelled) {
    if (point.mobility == wanted) points.push_back(point.p_map);
  }
  return points;
}

TEST(MapRemoval, TheStaticPointsAloneArePerfect) {
  const MapRemoval removal = map_removal(street(), without_labels(street(), Mobility::at_rest));
  EXPECT_EQ(removal.static_voxels, 8U);
  EXPECT_EQ(removal.dynamic_voxels, 4U);
  for (const auto& measure :
       {removal.preservation_rate(), removal.rejection_rate(), removal.f1(), removal.static_accuracy(),
        removal.dynamic_accuracy(), removal.associated_accuracy()}) {
    EXPECT_EQ(measure, 1.0);
  }
}

TEST(MapRemoval, KnownCase) {
  // 6 of 8 static voxels kept, 1 of 4 dynamic ones.
  Points map;
  for (const int i : {0, 1, 2, 3, 4, 5, 12}) map.push_back(in_voxel(i));
  const MapRemoval removal = map_removal(street(), map);
  EXPECT_DOUBLE_EQ(removal.preservation_rate().value(), 0.75);
  EXPECT_DOUBLE_EQ(removal.rejection_rate().value(), 0.75);
  EXPECT_DOUBLE_EQ(removal.f1().value(), 0.75);
  EXPECT_DOUBLE_EQ(removal.static_accuracy().value(), 0.75);
  EXPECT_DOUBLE_EQ(removal.dynamic_accuracy().value(), 0.75);
  EXPECT_DOUBLE_EQ(removal.associated_accuracy().value(), 0.75);
}

TEST(MapRemoval, AMapOfEverythingPreservesAllAndRejectsNothing) {
  Points map = without_labels(street(), Mobility::at_rest);
  for (const Eigen::Vector3f& point : without_labels(street(), Mobility::moving)) map.push_back(point);
  const MapRemoval removal = map_removal(street(), map);
  EXPECT_EQ(removal.preservation_rate(), 1.0);
  EXPECT_EQ(removal.rejection_rate(), 0.0);
  EXPECT_EQ(removal.f1(), 0.0);
  EXPECT_EQ(removal.associated_accuracy(), 0.0);
}

TEST(MapRemoval, AnEmptyMapRejectsAllAndPreservesNothing) {
  const MapRemoval removal = map_removal(street(), {});
  EXPECT_EQ(removal.preservation_rate(), 0.0);
  EXPECT_EQ(removal.rejection_rate(), 1.0);
  EXPECT_EQ(removal.static_accuracy(), 0.0);
  EXPECT_EQ(removal.dynamic_accuracy(), 1.0);
  EXPECT_EQ(removal.f1(), 0.0);
}

TEST(MapRemoval, VoxelsBelongToTheirMajorityAndTiesAreAtRest) {
  Labelled truth;
  for (const Mobility mobility : {Mobility::at_rest, Mobility::moving, Mobility::moving}) {
    truth.push_back({in_voxel(0), mobility});
  }
  for (const Mobility mobility : {Mobility::at_rest, Mobility::moving}) {
    truth.push_back({in_voxel(1), mobility});
  }
  const MapRemoval removal = map_removal(truth, Points{in_voxel(1)});
  EXPECT_EQ(removal.dynamic_voxels, 1U);
  EXPECT_EQ(removal.static_voxels, 1U);
  EXPECT_EQ(removal.preservation_rate(), 1.0);
  EXPECT_EQ(removal.rejection_rate(), 1.0);
}

TEST(MapRemoval, DistanceDecidesPointsAndVoxelsDecideRates) {
  // The map's point lies 0.06 m off, in the same voxel.
  const Labelled truth{{in_voxel(0), Mobility::at_rest}};
  const Points map{in_voxel(0) + Eigen::Vector3f(0.06F, 0.0F, 0.0F)};
  EXPECT_EQ(map_removal(truth, map, {.distance_m = 0.05}).static_accuracy(), 0.0);
  EXPECT_EQ(map_removal(truth, map, {.distance_m = 0.07}).static_accuracy(), 1.0);
  EXPECT_EQ(map_removal(truth, map, {.distance_m = 0.05}).preservation_rate(), 1.0);
  EXPECT_EQ(map_removal(truth, map, {.voxel_m = 0.05}).preservation_rate(), 0.0);
}

TEST(MapRemoval, TheGridOfTheMapDoesNotMatter) {
  // A point 1 mm across the border of the voxel is as good as one within.
  const Labelled truth{{{0.199F, 0.1F, 0.1F}, Mobility::at_rest}};
  EXPECT_EQ(map_removal(truth, Points{{0.201F, 0.1F, 0.1F}}).preservation_rate(), 1.0);
  EXPECT_EQ(map_removal(truth, Points{{0.380F, 0.1F, 0.1F}}).preservation_rate(), 0.0);
}

TEST(MapRemoval, WhatIsUnknownOrNotFiniteDoesNotCount) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Labelled truth = street();
  truth.push_back({in_voxel(30), Mobility::unknown});
  truth.push_back({{kNan, 0.0F, 0.0F}, Mobility::moving});
  Points map = without_labels(street(), Mobility::at_rest);
  map.emplace_back(0.0F, kNan, 0.0F);
  const MapRemoval removal = map_removal(truth, map);
  EXPECT_EQ(removal.static_voxels + removal.dynamic_voxels, 12U);
  EXPECT_EQ(removal.f1(), 1.0);
}

TEST(MapRemoval, NothingToCountGivesNothing) {
  const MapRemoval nothing = map_removal({}, {});
  EXPECT_FALSE(nothing.preservation_rate() || nothing.rejection_rate() || nothing.f1() ||
               nothing.static_accuracy() || nothing.dynamic_accuracy() || nothing.associated_accuracy());
  const MapRemoval all_static = map_removal(Labelled{{in_voxel(0), Mobility::at_rest}}, Points{in_voxel(0)});
  EXPECT_EQ(all_static.preservation_rate(), 1.0);
  EXPECT_FALSE(all_static.f1() || all_static.associated_accuracy());
}

TEST(MapRemoval, TheSameForAnyNumberOfThreads) {
  Labelled truth;
  Points map;
  for (int i = 0; i < 3000; ++i) {
    truth.push_back({in_voxel(i), i % 3 == 0 ? Mobility::moving : Mobility::at_rest});
    if (i % 5 != 0) map.push_back(in_voxel(i));
  }
  MapRemoval alone;
  tbb::task_arena(1).execute([&] { alone = map_removal(truth, map); });
  const MapRemoval together = map_removal(truth, map);
  EXPECT_EQ(alone.static_points_kept, together.static_points_kept);
  EXPECT_EQ(alone.dynamic_points_kept, together.dynamic_points_kept);
  EXPECT_EQ(together.static_points_kept, 1600U);
  EXPECT_EQ(together.dynamic_points_kept, 800U);
}

}  // namespace
}  // namespace mlo
