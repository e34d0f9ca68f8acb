#pragma once

#include <cmath>

#include <Eigen/Core>
#include <tsl/robin_set.h>

#include "mlo/core/voxel_grid.hpp"

namespace mlo {

/// Upright columns of space, unlimited in height, square seen from above.
class ColumnSet {
 public:
  ColumnSet() = default;
  explicit ColumnSet(double column_m) : inverse_size_(static_cast<float>(1.0 / column_m)) {}

  VoxelKey key_of(const Eigen::Vector3f& p) const {
    return {static_cast<int>(std::floor(p.x() * inverse_size_)),
            static_cast<int>(std::floor(p.y() * inverse_size_)), 0};
  }
  void insert(const VoxelKey& key) { keys_.insert(key); }
  bool contains(const Eigen::Vector3f& p) const { return !keys_.empty() && keys_.contains(key_of(p)); }

 private:
  float inverse_size_ = 1.0F;
  tsl::robin_set<VoxelKey, VoxelKeyHash> keys_;
};

}  // namespace mlo
