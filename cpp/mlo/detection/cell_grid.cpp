#include "mlo/detection/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mlo {
namespace {

constexpr std::int32_t kEmpty = -1;

/// Disjoint sets; the smallest member stands for each.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

struct Offset {
  int column;
  int row;
};

// The half of a disc of cells that comes later in the grid's order, the nearest first.
std::vector<Offset> half_disc(int radius) {
  std::vector<Offset> offsets;
  for (int row = 0; row <= radius; ++row) {
    for (int column = row == 0 ? 1 : -radius; column <= radius; ++column) {
      // gaps are those between cells, not between their middles
      const int dx = std::max(std::abs(column) - 1, 0);
      const int dy = std::max(row - 1, 0);
      if (dx * dx + dy * dy < radius * radius) offsets.push_back({column, row});
    }
  }
  return offsets;
}

void connect(const CellGrid& grid, double gap_m, double growth, DisjointSets& sets) {
  std::vector<std::vector<Offset>> discs;
  for (std::uint32_t i = 0; i < grid.cells().size(); ++i) {
    const CellGrid::Cell& cell = grid.cells()[i];
    const double allowed_m = gap_m + growth * static_cast<double>(cell.range_m);
    const auto radius = static_cast<std::size_t>(std::lround(allowed_m / static_cast<double>(grid.cell_m())));
    while (discs.size() <= radius) discs.push_back(half_disc(static_cast<int>(discs.size())));
    for (const Offset& offset : discs[radius]) {
      const int other = grid.find(cell.column + offset.column, cell.row + offset.row);
      if (other != kEmpty) sets.unite(i, static_cast<std::uint32_t>(other));
    }
  }
}

/// Members of each set, by its smallest.
std::vector<CellCluster> members(DisjointSets& sets, std::size_t count) {
  std::vector<CellCluster> by_root(count);
  for (std::uint32_t i = 0; i < count; ++i) by_root[sets.find(i)].push_back(i);
  return by_root;
}

}  // namespace

CellGrid::CellGrid(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                   const GroundHeights& ground, const ClusterConfig& config)
    : cell_m_(static_cast<float>(config.cell_m)),
      reach_m_(static_cast<float>(config.reach_m)),
      side_(static_cast<int>(std::ceil(2.0F * reach_m_ / cell_m_))) {
  const auto num_places = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
  ground_.assign(num_places, 0);
  index_.assign(num_places, 0);  // counts the points first
  std::vector<float> top_m(num_places, 0.0F);
  std::vector<std::pair<std::size_t, ElevatedPoint>> connecting;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i].p_lidar;
    const int column = coordinate(p.x());
    const int row = coordinate(p.y());
    if (!inside(column, row)) continue;
    const std::size_t at = place(column, row);
    if (is_ground[i] != 0) {
      ground_[at] = 1;
      continue;
    }
    const float height_m = p.z() - ground.at(p.head<2>());
    top_m[at] = std::max(top_m[at], height_m);
    if (!(height_m >= config.min_height_m && height_m <= config.max_height_m)) continue;
    connecting.emplace_back(at, ElevatedPoint{p, height_m});
    ++index_[at];
  }
  std::uint32_t begin = 0;
  for (std::size_t at = 0; at < num_places; ++at) {
    const auto count = static_cast<std::uint32_t>(index_[at]);
    index_[at] = count == 0 ? kEmpty : static_cast<std::int32_t>(cells_.size());
    if (count == 0) continue;
    const int column = static_cast<int>(at) % side_;
    const int row = static_cast<int>(at) / side_;
    const Eigen::Vector2f middle((static_cast<float>(column) + 0.5F) * cell_m_ - reach_m_,
                                 (static_cast<float>(row) + 0.5F) * cell_m_ - reach_m_);
    cells_.push_back({column, row, middle.norm(), begin, begin, top_m[at]});
    begin += count;
  }
  points_.resize(connecting.size());
  for (const auto& [at, point] : connecting) {
    points_[cells_[static_cast<std::size_t>(index_[at])].end++] = point;
  }
}

int CellGrid::coordinate(float along_m) const {
  return static_cast<int>(std::floor((along_m + reach_m_) / cell_m_));
}

int CellGrid::find(int column, int row) const {
  return inside(column, row) ? index_[place(column, row)] : kEmpty;
}

int CellGrid::find(const Eigen::Vector2f& p_lidar) const {
  return find(coordinate(p_lidar.x()), coordinate(p_lidar.y()));
}

bool CellGrid::shows_ground(const Eigen::Vector2f& p_lidar) const {
  const int column = coordinate(p_lidar.x());
  const int row = coordinate(p_lidar.y());
  return inside(column, row) && ground_[place(column, row)] != 0;
}

std::vector<CellCluster> cluster_cells(const CellGrid& grid, const ClusterConfig& config) {
  const std::size_t count = grid.cells().size();
  std::vector<double> gaps_m = config.gaps_m;
  std::ranges::sort(gaps_m);
  DisjointSets sets(count);
  std::vector<CellCluster> clusters;
  std::vector<std::size_t> size_before(count, 0);  // of the set that a cell stands for
  for (const double gap_m : gaps_m) {
    connect(grid, gap_m, config.gap_growth, sets);
    std::vector<CellCluster> groups = members(sets, count);
    for (std::size_t root = 0; root < count; ++root) {
      if (groups[root].empty() || groups[root].size() == size_before[root]) continue;
      size_before[root] = groups[root].size();
      clusters.push_back(std::move(groups[root]));
    }
  }
  return clusters;
}

}  // namespace mlo
