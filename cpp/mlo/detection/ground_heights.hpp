#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mlo/core/types.hpp"

namespace mlo {

/// Height of the ground around the lidar on a grid of cells, from the points that were taken for ground;
/// cells without any take that of the nearest ones that have some.
class GroundHeights {
 public:
  /// @param is_ground  per point: 1 ground, 0 not
  GroundHeights(std::span<const Point> points, std::span<const std::uint8_t> is_ground, double reach_m);

  /// z of the ground in the lidar frame [m]; that of the nearest cell beyond the reach. 0 where no ground was
  /// seen at all.
  float at(const Eigen::Vector2f& p_lidar) const;
  /// The same between the middles of the cells around: without steps.
  float interpolated_at(const Eigen::Vector2f& p_lidar) const;
  bool empty() const { return !found_; }

 private:
  int index_of(float coordinate) const;
  std::size_t place(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(column);
  }
  void fill();

  float reach_m_;
  int side_ = 0;  ///< cells along each axis
  std::vector<float> z_;
  bool found_ = false;
};

}  // namespace mlo
