#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/types.hpp"
#include "mlo/perception/config.hpp"

namespace mlo {

/// A point and its place in the scan.
struct ZonePoint {
  Eigen::Vector3f p_lidar;
  std::uint32_t index;
};

/// The points of a scan sorted into azimuth sectors, and those into zones from near to far whose depth grows
/// with range. Within a zone the points keep their order.
class PolarZones {
 public:
  /// Coordinates must be finite.
  PolarZones(std::span<const Point> points, const GroundConfig& config);

  std::size_t num_sectors() const { return num_sectors_; }
  std::size_t num_zones() const { return edges_m_.size() - 1; }
  std::span<const ZonePoint> points(std::size_t sector, std::size_t zone) const {
    const std::size_t cell = sector * num_zones() + zone;
    return std::span<const ZonePoint>(points_).subspan(cell_begin_[cell],
                                                       cell_begin_[cell + 1] - cell_begin_[cell]);
  }
  float near_edge_m(std::size_t zone) const { return edges_m_[zone]; }
  float far_edge_m(std::size_t zone) const { return edges_m_[zone + 1]; }
  float depth_m(std::size_t zone) const { return edges_m_[zone + 1] - edges_m_[zone]; }
  /// Where a zone begins, in the middle of its sector, seen from above [m].
  Eigen::Vector2f near_border(std::size_t sector, std::size_t zone) const;

 private:
  std::vector<std::uint16_t> cells_of(std::span<const Point> points) const;

  std::size_t num_sectors_;
  std::vector<float> edges_m_;  ///< where zones begin and end, seen from above
  std::vector<ZonePoint> points_;
  std::vector<std::size_t> cell_begin_;
};

}  // namespace mlo
