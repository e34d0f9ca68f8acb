#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/voxel_grid.hpp"
#include "mlo/mapping/config.hpp"
#include "mlo/mapping/voxel_block.hpp"

namespace mlo {

/// The nearest map points of a query, nearest first; fixed storage, as it is filled millions of times.
struct NearestPoints {
  static constexpr int kMax = 8;  // as a search keeps its best in one register
  std::array<Eigen::Vector3f, kMax> points;
  std::array<float, kMax> squared_distances_m2;
  int count = 0;
};

/// Points around the robot in a voxel hash, each to 1/256 of a voxel; memory is bounded by
/// forget_beyond_radius().
class LocalMap {
 public:
  explicit LocalMap(const LocalMapConfig& config);

  /// Adds points (map frame [m]) in order; those too near to others of their voxel are left out.
  /// @return for each point 1 if it was added, 0 if not
  std::vector<std::uint8_t> insert(std::span<const Eigen::Vector3f> points_map);

  /// Forgets the voxels farther than the configured radius from a place (map frame [m]). Does nothing until
  /// the place has moved by a twentieth of the radius since it last did, so that it may be called every scan.
  void forget_beyond_radius(const Eigen::Vector3f& center_map);

  /// The k nearest points within the query's voxel and its 26 neighbours; none if even the nearest is beyond
  /// gate_m. Of points whose squared distances differ by less than 1/8000, either may be taken for the
  /// nearer. The query must be finite.
  /// @param k  in [1, NearestPoints::kMax]
  NearestPoints nearest(const Eigen::Vector3f& query_map, int k, float gate_m) const;

  bool empty() const { return num_voxels_ == 0; }
  std::size_t num_voxels() const { return num_voxels_; }
  void clear();

  /// All but the configuration (core/archive.hpp).
  static void archive(auto& self, auto& bytes) {
    bytes(self.blocks_, self.pools_, self.num_voxels_, self.num_taken_, self.free_, self.last_center_map_);
  }

 private:
  // One cache line, as a search is bound by memory.
  struct alignas(64) Voxel {
    static constexpr std::size_t kMaxPoints = 20;
    // Distances are computed to so many places, a multiple of eight, side by side; the last are no points.
    static constexpr std::size_t kLanes = 24;

    // All x, all y, all z, in 1/256 of the voxel's side from its middle; then the number of points.
    std::array<std::int16_t, 64> data{};

    std::size_t count() const { return static_cast<std::size_t>(data[3 * kMaxPoints]); }
    /// From a place to each point, both in steps from the voxel's middle; what is beyond count() means
    /// nothing.
    [[gnu::always_inline]] std::array<float, kLanes> squared_distances(const Eigen::Vector3f& p) const;
    void push_back(const Eigen::Vector3f& p);
    void clear() { data[3 * kMaxPoints] = 0; }
    Eigen::Vector3f point(std::size_t i) const;
    void prefetch() const { __builtin_prefetch(data.data()); }
    static void archive(auto& self, auto& bytes) { bytes(self.data); }
  };

  class Neighbourhood;

  // Voxels live in pools, so that growing never moves them: no scan pays for copying the map.
  static constexpr std::uint32_t kPoolBits = 10;
  Voxel& voxel(std::uint32_t place) { return pools_[place >> kPoolBits][place & ((1U << kPoolBits) - 1U)]; }
  const Voxel& voxel(std::uint32_t place) const {
    return pools_[place >> kPoolBits][place & ((1U << kPoolBits) - 1U)];
  }
  std::uint32_t take_voxel();
  bool has_room(const Voxel& voxel, const Eigen::Vector3f& steps) const;
  Eigen::Vector3f middle(const VoxelKey& key) const;
  bool forget_beyond(const VoxelKey& block_key, VoxelBlock& block, const VoxelKey& center,
                     double radius_voxels);

  LocalMapConfig config_;
  float inverse_voxel_;
  float step_m_;  // of the coordinates in a voxel
  VoxelBlocks blocks_;
  std::vector<std::vector<Voxel>> pools_;
  std::size_t num_voxels_ = 0;
  std::uint32_t num_taken_ = 0;  // places that were ever taken; some of them are free again
  std::vector<std::uint32_t> free_;
  Eigen::Vector3f last_center_map_ = Eigen::Vector3f::Zero();
};

}  // namespace mlo
