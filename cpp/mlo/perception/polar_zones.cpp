#include "mlo/perception/polar_zones.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

/// Points farther than this fall into the last zone [m].
constexpr float kFarthest = 120.0F;
/// Points handled by one task; fixed, so that tasks do not depend on the number of threads.
constexpr std::size_t kBlock = 8192;

std::vector<float> zone_edges(const GroundConfig& config) {
  std::vector<float> edges{0.0F};
  while (edges.back() < kFarthest) {
    const float depth = std::max(static_cast<float>(config.zone_depth_m),
                                 static_cast<float>(config.zone_growth) * edges.back());
    edges.push_back(edges.back() + depth);
  }
  return edges;
}

/// Azimuth in turns, in [0, 1], to 0.001 turns: enough to choose a sector, and far cheaper than atan2.
float rough_turns(float x, float y) {
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float ratio = std::min(ax, ay) / std::max({ax, ay, 1e-6F});
  float turns = ratio * (0.125F + 0.04345F * (1.0F - ratio));  // arc tangent within the first eighth
  turns = ay > ax ? 0.25F - turns : turns;
  turns = x < 0.0F ? 0.5F - turns : turns;
  return y < 0.0F ? 1.0F - turns : turns;
}

}  // namespace

PolarZones::PolarZones(std::span<const Point> points, const GroundConfig& config)
    : num_sectors_(static_cast<std::size_t>(config.sectors)), edges_m_(zone_edges(config)) {
  const std::vector<std::uint16_t> cells = cells_of(points);
  const std::size_t num_cells = num_sectors_ * num_zones();
  const std::size_t num_blocks = (points.size() + kBlock - 1) / kBlock;
  // A stable counting sort: each block counts its points per cell, then knows where to put them.
  std::vector<std::vector<std::uint32_t>> place(num_blocks, std::vector<std::uint32_t>(num_cells, 0));
  const auto for_each_block = [&](const auto& body) {
    parallel_for_each_index(num_blocks, [&](std::size_t block) {
      const std::size_t end = std::min(points.size(), (block + 1) * kBlock);
      for (std::size_t i = block * kBlock; i < end; ++i) body(i, place[block][cells[i]]);
    });
  };
  for_each_block([](std::size_t, std::uint32_t& count) { ++count; });
  cell_begin_.assign(num_cells + 1, points.size());
  std::uint32_t next = 0;
  for (std::size_t cell = 0; cell < num_cells; ++cell) {
    cell_begin_[cell] = next;
    for (std::vector<std::uint32_t>& block : place) {
      const std::uint32_t count = block[cell];
      block[cell] = next;
      next += count;
    }
  }
  points_.resize(points.size());
  for_each_block([&](std::size_t i, std::uint32_t& to) {
    points_[to++] = {points[i].p_lidar, static_cast<std::uint32_t>(i)};
  });
}

std::vector<std::uint16_t> PolarZones::cells_of(std::span<const Point> points) const {
  constexpr float kStep = 0.25F;  // of a table that saves searching the edges [m]
  std::vector<std::uint16_t> zone_at(static_cast<std::size_t>(kFarthest / kStep) + 1);
  std::uint16_t zone = 0;
  for (std::size_t i = 0; i < zone_at.size(); ++i) {
    while (edges_m_[zone + 1U] <= static_cast<float>(i) * kStep && zone + 1U < num_zones()) ++zone;
    zone_at[i] = zone;
  }
  std::vector<std::uint16_t> cells(points.size());
  parallel_for_each_index(
      points.size(),
      [&](std::size_t i) {
        const Eigen::Vector3f& p = points[i].p_lidar;
        const float range = std::min(p.head<2>().norm(), kFarthest);
        const auto sector =
            static_cast<std::size_t>(rough_turns(p.x(), p.y()) * static_cast<float>(num_sectors_));
        cells[i] = static_cast<std::uint16_t>(std::min(sector, num_sectors_ - 1) * num_zones() +
                                              zone_at[static_cast<std::size_t>(range / kStep)]);
      },
      kBlock);
  return cells;
}

Eigen::Vector2f PolarZones::near_border(std::size_t sector, std::size_t zone) const {
  const float azimuth_rad = (static_cast<float>(sector) + 0.5F) / static_cast<float>(num_sectors_) * 2.0F *
                            std::numbers::pi_v<float>;
  return edges_m_[zone] * Eigen::Vector2f(std::cos(azimuth_rad), std::sin(azimuth_rad));
}

}  // namespace mlo
