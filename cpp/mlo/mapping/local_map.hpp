#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mlo/core/voxel_grid.hpp"
#include "mlo/mapping/config.hpp"

namespace mlo {

/// The nearest map points of a query, nearest first; fixed storage, as it is filled millions of times.
struct NearestPoints {
  static constexpr int kMax = 20;
  std::array<Eigen::Vector3f, kMax> points;
  std::array<float, kMax> squared_distances_m2;
  int count = 0;
};

/// Points around the robot in a voxel hash; memory is bounded by forget_beyond_radius().
class LocalMap {
 public:
  explicit LocalMap(const LocalMapConfig& config);

  /// Adds points (map frame [m]) in order; those too near to others of their voxel are left out.
  void insert(std::span<const Eigen::Vector3f> points_map);

  /// Forgets the voxels farther than the configured radius from a place (map frame [m]).
  void forget_beyond_radius(const Eigen::Vector3f& center_map);

  /// The k nearest points within the query's voxel and its 26 neighbours; none if even the nearest is beyond
  /// gate_m. The query must be finite.
  /// @param k  in [1, NearestPoints::kMax]
  NearestPoints nearest(const Eigen::Vector3f& query_map, int k, float gate_m) const;

  bool empty() const { return index_.empty(); }
  std::size_t num_voxels() const { return index_.size(); }
  void clear();

 private:
  struct Voxel {
    std::array<Eigen::Vector3f, NearestPoints::kMax> points;
    std::uint32_t count = 0;
  };

  LocalMapConfig config_;
  float inverse_voxel_;
  tsl::robin_map<VoxelKey, std::uint32_t, VoxelKeyHash> index_;  // key to place in voxels_
  std::vector<Voxel> voxels_;
  std::vector<std::uint32_t> free_;
};

}  // namespace mlo
