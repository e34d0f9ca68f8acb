#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace mlo {

/// Points [m] as nanoflann wants to see them.
/// @tparam Points  a container or span of Eigen::Vector3f
template <class Points>
struct KdTreePoints {
  Points points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return points[index][static_cast<Eigen::Index>(axis)];
  }
  template <class BoundingBox>
  bool kdtree_get_bbox(BoundingBox&) const {
    return false;
  }
};

}  // namespace mlo
