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

  /// Forgets the voxels farther than the configured radius from a place (map frame [m]). Does nothing until
  /// the place has moved by a twentieth of the radius since it last did, so that it may be called every scan.
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

  // Voxels live in blocks, so that growing never moves them: no scan pays for copying the map.
  static constexpr std::uint32_t kBlockBits = 10;
  Voxel& voxel(std::uint32_t place) { return blocks_[place >> kBlockBits][place & ((1U << kBlockBits) - 1U)]; }
  const Voxel& voxel(std::uint32_t place) const {
    return blocks_[place >> kBlockBits][place & ((1U << kBlockBits) - 1U)];
  }
  std::uint32_t take_voxel();

  LocalMapConfig config_;
  float inverse_voxel_;
  tsl::robin_map<VoxelKey, std::uint32_t, VoxelKeyHash> index_;  // key to place in the blocks
  std::vector<std::vector<Voxel>> blocks_;
  std::uint32_t num_taken_ = 0;  // places that were ever taken; some of them are free again
  std::vector<std::uint32_t> free_;
  Eigen::Vector3f last_center_map_ = Eigen::Vector3f::Zero();
};

}  // namespace mlo
