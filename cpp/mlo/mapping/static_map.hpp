#pragma once

#include <tsl/robin_set.h>

#include <span>
#include <vector>

#include "mlo/core/features.hpp"
#include "mlo/core/sweep_motion.hpp"
#include "mlo/core/types.hpp"
#include "mlo/core/voxel_grid.hpp"
#include "mlo/mapping/config.hpp"

namespace mlo {

/// The long-term static map: environment points of all scans, one per voxel, without the points of objects.
class StaticMap {
 public:
  explicit StaticMap(const StaticMapConfig& config);

  /// Adds the candidate sets of a scan.
  /// @param motion       brings the points to the time of the pose
  /// @param T_map_lidar  pose at the motion's reference time
  void insert(const Percept& percept, const SweepMotion& motion, const SE3& T_map_lidar);

  std::span<const MapPoint> points() const { return points_; }

 private:
  void insert(std::span<const FeaturePoint> features, MapLabel label, const SweepMotion& motion,
              const SE3& T_map_lidar);

  float inverse_voxel_;
  tsl::robin_set<VoxelKey, VoxelKeyHash> occupied_;
  std::vector<MapPoint> points_;
};

}  // namespace mlo
