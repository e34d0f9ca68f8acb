#pragma once

#include <cstdint>
#include <vector>

#include <tsl/robin_set.h>

#include "mlo/core/random.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/core/types.hpp"
#include "mlo/simulator/lidar_model.hpp"

namespace mlo::simulator {

/// The true static surfaces that a drive has seen: places of returns without noise, one per voxel.
class StaticMap {
 public:
  explicit StaticMap(double voxel_m) : voxel_m_(voxel_m) {}
  /// @param T_map_world  into the frame that the map is wanted in
  void add(const Sweep& sweep, const SE3& T_map_world);
  const std::vector<MapPoint>& points() const { return points_; }

 private:
  /// Neighbouring voxels have neighbouring keys: without mixing, they would crowd the table.
  struct KeyHash {
    std::size_t operator()(std::uint64_t key) const { return mix(key, 0); }
  };
  double voxel_m_;
  tsl::robin_set<std::uint64_t, KeyHash> taken_;
  std::vector<MapPoint> points_;
};

}  // namespace mlo::simulator
