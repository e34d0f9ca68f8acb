#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mlo/core/types.hpp"
#include "mlo/detection/config.hpp"
#include "mlo/detection/ground_heights.hpp"

namespace mlo {

/// A point that may lie on an object.
struct ElevatedPoint {
  Eigen::Vector3f p_lidar = Eigen::Vector3f::Zero();
  float height_m = 0.0F;  ///< above the ground
};

/// The elevated points of a scan in square cells seen from above. Only occupied cells are kept.
class CellGrid {
 public:
  struct Cell {
    int column = 0;
    int row = 0;
    float range_m = 0.0F;
    std::uint32_t begin = 0;  ///< first of its points in points()
    std::uint32_t end = 0;
    float top_m = 0.0F;  ///< height of its highest return, also of those too high to connect
  };

  CellGrid(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
           const GroundHeights& ground, const ClusterConfig& config);

  std::span<const Cell> cells() const { return cells_; }
  std::span<const ElevatedPoint> points_of(const Cell& cell) const {
    return std::span<const ElevatedPoint>(points_).subspan(cell.begin, cell.end - cell.begin);
  }
  /// Index of a cell; -1 if it is empty or outside.
  int find(int column, int row) const;
  /// The same at a place in the lidar frame.
  int find(const Eigen::Vector2f& p_lidar) const;
  /// True if a return from the ground lies in the cell of a place.
  bool shows_ground(const Eigen::Vector2f& p_lidar) const;
  float cell_m() const { return cell_m_; }

 private:
  int coordinate(float along_m) const;
  std::size_t place(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(column);
  }
  bool inside(int column, int row) const { return column >= 0 && row >= 0 && column < side_ && row < side_; }

  float cell_m_;
  float reach_m_;
  int side_;
  std::vector<std::int32_t> index_;    ///< of each place in cells_
  std::vector<std::uint8_t> ground_;   ///< of each place: 1 where the ground is seen
  std::vector<Cell> cells_;            ///< row by row
  std::vector<ElevatedPoint> points_;  ///< cell by cell, in each as the scan has them
};

/// Cells that belong together, as indices into CellGrid::cells(), ascending.
using CellCluster = std::vector<std::uint32_t>;

/// Groups of cells no farther apart than each of the gaps in turn (gaps_m, plus gap_growth times the range).
/// Single linkage: the groups of a gap are unions of those of the smaller ones; each is listed once.
std::vector<CellCluster> cluster_cells(const CellGrid& grid, const ClusterConfig& config);

}  // namespace mlo
