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

  std::size_t size() const;
  /// All points, in an order that depends only on what was inserted.
  std::vector<MapPoint> points() const;

 private:
  void insert(std::span<const FeaturePoint> features, MapLabel label, const SweepMotion& motion,
              const SE3& T_map_lidar);

  /// Part of the voxels, chosen by their hash: tables that grow one after the other spread the cost of growing
  /// over the scans.
  struct Shard {
    tsl::robin_set<VoxelKey, VoxelKeyHash> occupied;
    std::vector<MapPoint> points;
  };
  static constexpr std::size_t kNumShards = 64;

  float inverse_voxel_;
  std::vector<Shard> shards_;
};

}  // namespace mlo
