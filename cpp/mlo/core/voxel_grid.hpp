#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <tsl/robin_set.h>

namespace mlo {

/// Index of a cube of space.
struct VoxelKey {
  int x = 0;
  int y = 0;
  int z = 0;
  bool operator==(const VoxelKey&) const = default;
  static void archive(auto& self, auto& bytes) { bytes(self.x, self.y, self.z); }  // core/archive.hpp
};

/// The voxel that holds a point, with inverse_size [1/m] one over the voxel's side; voxels start at multiples
/// of their side, also below zero. The point must be finite and fewer than 2^31 voxels from the origin.
inline VoxelKey voxel_key(const Eigen::Vector3f& p, float inverse_size) {
  return {static_cast<int>(std::floor(p.x() * inverse_size)),
          static_cast<int>(std::floor(p.y() * inverse_size)),
          static_cast<int>(std::floor(p.z() * inverse_size))};
}

struct VoxelKeyHash {
  std::size_t operator()(const VoxelKey& key) const {
    // Three odd multipliers keep the axes apart; the shift brings the well-mixed high bits down, where hash
    // tables of a power of two look.
    const std::uint64_t mixed = static_cast<std::uint64_t>(key.x) * 0x9E3779B97F4A7C15ULL +
                                static_cast<std::uint64_t>(key.y) * 0xC2B2AE3D27D4EB4FULL +
                                static_cast<std::uint64_t>(key.z) * 0x165667B19E3779F9ULL;
    return static_cast<std::size_t>(mixed ^ (mixed >> 32U));
  }
};

/// The first point of each voxel of side voxel_m [m], > 0, in the order given.
/// @param position  gives the place of a T as Eigen::Vector3f [m]
template <class T, class Position>
std::vector<T> downsample_first(std::span<const T> points, float voxel_m, Position position) {
  const float inverse_size = 1.0F / voxel_m;
  tsl::robin_set<VoxelKey, VoxelKeyHash> taken;
  taken.reserve(points.size() / 4);  // what dense scans leave; the table grows if it must
  std::vector<T> kept;
  VoxelKey last;
  for (const T& point : points) {
    const VoxelKey key = voxel_key(position(point), inverse_size);
    const bool repeated = !kept.empty() && key == last;  // as most neighbours in a scan line are
    last = key;
    if (!repeated && taken.insert(key).second) kept.push_back(point);
  }
  return kept;
}

}  // namespace mlo
