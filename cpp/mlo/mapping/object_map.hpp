#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <tsl/robin_set.h>

#include "mlo/core/se3.hpp"
#include "mlo/core/voxel_grid.hpp"

namespace mlo {

/// The points of one object in its own frame, one per voxel, in the order in which they were seen.
class ObjectMap {
 public:
  /// @param points_map    map frame [m]
  /// @param T_map_object  the object's pose when they were seen
  void insert(std::span<const Eigen::Vector3f> points_map, const SE3& T_map_object, double voxel_m);
  void clear();
  const std::vector<Eigen::Vector3f>& points_object() const { return points_; }
  static void archive(auto& self, auto& bytes) { bytes(self.points_, self.taken_); }  // core/archive.hpp

 private:
  std::vector<Eigen::Vector3f> points_;
  tsl::robin_set<VoxelKey, VoxelKeyHash> taken_;
};

}  // namespace mlo
