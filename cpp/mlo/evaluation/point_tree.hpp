#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <nanoflann.hpp>

// Internal to evaluation: nearest neighbours among points.
namespace mlo {

/// Points as nanoflann wants to see them.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return points[index][static_cast<Eigen::Index>(axis)];
  }
  template <class BoundingBox>
  bool kdtree_get_bbox(BoundingBox&) const {
    return false;
  }
};

/// PointTree(3, cloud); the cloud must outlive it, not be empty and hold finite points only.
using PointTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PointCloud>,
                                                      PointCloud, 3, std::size_t>;

}  // namespace mlo
