#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <tsl/robin_map.h>

#include "mlo/core/voxel_grid.hpp"

namespace mlo {

/// Where to find what belongs to each of 4 x 4 x 4 voxels. Voxels that are looked up together are mostly of
/// one block or two: that spares most searches of the hash table, and most waiting for memory.
struct VoxelBlock {
  static constexpr int kBits = 2;
  static constexpr int kSide = 1 << kBits;
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  VoxelBlock() { places.fill(kNone); }
  /// Of the block that holds a voxel.
  static VoxelKey key_of(const VoxelKey& voxel) {
    return {voxel.x >> kBits, voxel.y >> kBits, voxel.z >> kBits};
  }
  /// The place of one of its voxels; kNone where there is nothing.
  std::uint32_t& at(const VoxelKey& voxel) { return places[index_of(voxel)]; }
  std::uint32_t at(const VoxelKey& voxel) const { return places[index_of(voxel)]; }
  static void archive(auto& self, auto& bytes) { bytes(self.places); }  // core/archive.hpp

 private:
  static std::size_t index_of(const VoxelKey& voxel) {
    constexpr int mask = kSide - 1;
    const int index = ((((voxel.x & mask) << kBits) | (voxel.y & mask)) << kBits) | (voxel.z & mask);
    return static_cast<std::size_t>(index);
  }

  std::array<std::uint32_t, std::size_t{kSide} * kSide * kSide> places;
};

using VoxelBlocks = tsl::robin_map<VoxelKey, VoxelBlock, VoxelKeyHash>;

}  // namespace mlo
