#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "detection/made_scan.hpp"
#include "mlo/detection/cell_grid.hpp"

namespace mlo {
namespace {

ClusterConfig one_gap(double gap_m) {
  ClusterConfig config;
  config.gaps_m = {gap_m};
  config.gap_growth = 0.0;
  return config;
}

struct Clustered {
  GroundHeights ground;
  CellGrid grid;
  std::vector<CellCluster> clusters;
};

Clustered cluster(const test::MadeScan& scan, const ClusterConfig& config) {
  const GroundHeights ground(scan.points, scan.is_ground, config.reach_m);
  CellGrid grid(scan.points, scan.is_ground, ground, config);
  std::vector<CellCluster> clusters = cluster_cells(grid, config);
  return {ground, std::move(grid), std::move(clusters)};
}

TEST(CellGrid, KeepsWhatStandsOnTheGround) {
  test::MadeScan scan;
  scan.add({10.0, 0.0, -1.7}, true);
  scan.add({10.1, 0.1, -1.65});  // too low
  scan.add({10.1, 0.1, -0.7});   // 1 m high
  scan.add({10.1, 0.1, 3.3});    // 5 m high: does not connect
  scan.add({200.0, 0.0, -0.7});  // too far
  const Clustered found = cluster(scan, one_gap(0.4));
  ASSERT_EQ(found.grid.cells().size(), 1U);
  const CellGrid::Cell& cell = found.grid.cells().front();
  ASSERT_EQ(found.grid.points_of(cell).size(), 1U);
  EXPECT_NEAR(found.grid.points_of(cell).front().height_m, 1.0F, 1e-5F);
  EXPECT_NEAR(cell.top_m, 5.0F, 1e-5F);
  EXPECT_EQ(found.grid.find(Eigen::Vector2f(10.1F, 0.1F)), 0);
  EXPECT_EQ(found.grid.find(Eigen::Vector2f(30.0F, 0.0F)), -1);
  EXPECT_EQ(found.grid.find(Eigen::Vector2f(-300.0F, 0.0F)), -1);
  EXPECT_TRUE(found.grid.shows_ground({10.05F, 0.05F}));
  EXPECT_FALSE(found.grid.shows_ground({300.0F, 0.0F}));
  EXPECT_EQ(cluster({}, one_gap(0.4)).clusters.size(), 0U);
}

TEST(ClusterCells, SmallGapsPartWhatLargeOnesJoin) {
  test::MadeScan scan;
  scan.add({0.0, 0.0, -1.7}, true);
  for (const double x_m : {5.0, 5.2, 5.4, 6.5, 6.7}) scan.add({x_m + 0.1, 5.1, -0.7});
  ClusterConfig config = one_gap(0.2);
  EXPECT_EQ(cluster(scan, config).clusters.size(), 2U);
  config.gaps_m = {1.2};
  EXPECT_EQ(cluster(scan, config).clusters.size(), 1U);
  config.gaps_m = {0.2, 1.2};  // both, and nothing twice
  EXPECT_EQ(cluster(scan, config).clusters.size(), 3U);
}

// Flood fill over all pairs of cells, as the definition says.
std::vector<CellCluster> by_brute_force(const CellGrid& grid, int radius) {
  const auto cells = grid.cells();
  std::vector<int> label(cells.size(), -1);
  std::vector<CellCluster> clusters;
  for (std::uint32_t seed = 0; seed < cells.size(); ++seed) {
    if (label[seed] >= 0) continue;
    label[seed] = static_cast<int>(clusters.size());
    CellCluster cluster{seed};
    for (std::size_t k = 0; k < cluster.size(); ++k) {
      for (std::uint32_t other = 0; other < cells.size(); ++other) {
        const int dx = std::max(std::abs(cells[other].column - cells[cluster[k]].column) - 1, 0);
        const int dy = std::max(std::abs(cells[other].row - cells[cluster[k]].row) - 1, 0);
        if (label[other] >= 0 || dx * dx + dy * dy >= radius * radius) continue;
        label[other] = label[seed];
        cluster.push_back(other);
      }
    }
    std::ranges::sort(cluster);
    clusters.push_back(cluster);
  }
  return clusters;
}

TEST(ClusterCells, EqualFloodFill) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> uniform(-12.0, 12.0);
  for (const int radius : {1, 2, 4}) {
    test::MadeScan scan;
    scan.add({0.0, 0.0, -1.7}, true);
    for (int i = 0; i < 600; ++i) scan.add({uniform(rng), uniform(rng), -1.0});
    const ClusterConfig config = one_gap(0.2 * radius);
    const Clustered found = cluster(scan, config);
    // clusters come in the order of their first cells; single cells are clusters, too
    EXPECT_EQ(found.clusters, by_brute_force(found.grid, radius));
  }
}

}  // namespace
}  // namespace mlo
