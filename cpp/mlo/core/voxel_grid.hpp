#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

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

/// A set of voxels that only grows. Of each axis it keeps 21 bits: voxels two million apart count as one.
class VoxelSet {
 public:
  /// @param expected  voxels there is room for at first
  explicit VoxelSet(std::size_t expected) : slots_(std::bit_ceil(2 * expected + 16), kFree) {}

  /// True if it was not there yet.
  bool insert(const VoxelKey& key) {
    if (2 * (size_ + 1) > slots_.size()) grow();
    std::uint64_t& slot = slot_of(packed(key));
    if (slot != kFree) return false;
    slot = packed(key);
    ++size_;
    return true;
  }

 private:
  static constexpr std::uint64_t kFree = ~std::uint64_t{0};

  static std::uint64_t packed(const VoxelKey& key) {
    const auto part = [](int value) { return static_cast<std::uint64_t>(value) & 0x1FFFFFU; };
    return part(key.x) << 42U | part(key.y) << 21U | part(key.z);
  }

  // The one that holds this, or the free one for it.
  std::uint64_t& slot_of(std::uint64_t wanted) {
    const std::size_t mask = slots_.size() - 1;
    const std::uint64_t mixed = wanted * 0x9E3779B97F4A7C15ULL;
    std::size_t i = static_cast<std::size_t>(mixed ^ (mixed >> 32U)) & mask;
    while (slots_[i] != kFree && slots_[i] != wanted) i = (i + 1) & mask;
    return slots_[i];
  }

  void grow() {
    std::vector<std::uint64_t> before(2 * slots_.size(), kFree);
    before.swap(slots_);
    for (const std::uint64_t held : before) {
      if (held != kFree) slot_of(held) = held;
    }
  }

  std::vector<std::uint64_t> slots_;
  std::size_t size_ = 0;
};

/// The first point of each voxel of side voxel_m [m], > 0, in the order given.
/// @param position  gives the place of a T as Eigen::Vector3f [m]
template <class T, class Position>
std::vector<T> downsample_first(std::span<const T> points, float voxel_m, Position position) {
  const float inverse_size = 1.0F / voxel_m;
  VoxelSet taken(points.size() / 4);  // what dense scans leave
  std::vector<T> kept;
  VoxelKey last;
  for (const T& point : points) {
    const VoxelKey key = voxel_key(position(point), inverse_size);
    const bool repeated = !kept.empty() && key == last;  // as most neighbours in a scan line are
    last = key;
    if (!repeated && taken.insert(key)) kept.push_back(point);
  }
  return kept;
}

}  // namespace mlo
