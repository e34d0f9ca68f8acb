#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <Eigen/Core>

// What a search for the points around a query is made of (LocalMap::nearest).
namespace mlo {

/// Places in a voxel are counted in so many steps along each side.
inline constexpr double kStepsPerVoxel = 65536.0;

/// From the voxel of a query to one near it, in voxels: +1 is towards the side of the voxel's middle on which
/// the query lies, -1 away from it.
struct Offset {
  int x, y, z;
};

/// So many voxels meet in the corner of the query's that it is next to, its own included.
inline constexpr std::size_t kNear = 8;

/// The query's voxel and the 26 around it: first those that meet in that corner, then the others; each by the
/// number of steps, so that later ones are often farther than what is already found.
constexpr std::array<Offset, 27> neighbour_offsets() {
  std::array<Offset, 27> offsets{};
  std::size_t n = 0;
  for (const bool near : {true, false}) {
    for (int steps = 0; steps <= 3; ++steps) {
      for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
          for (int z = -1; z <= 1; ++z) {
            const bool is_near = x >= 0 && y >= 0 && z >= 0;
            if (is_near == near && x * x + y * y + z * z == steps) offsets[n++] = {x, y, z};
          }
        }
      }
    }
  }
  return offsets;
}
inline constexpr std::array<Offset, 27> kNeighbours = neighbour_offsets();

/// Where a query lies in its voxel, and how far it is from the voxels around it; all in steps.
class InVoxel {
 public:
  /// @param from_middle  from the middle of the voxel to the query
  explicit InVoxel(const Eigen::Vector3f& from_middle) : from_middle_(from_middle) {
    constexpr auto half = static_cast<float>(0.5 * kStepsPerVoxel);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      side_(axis) = from_middle(axis) < 0.0F ? -1 : 1;
      const float aside = std::abs(from_middle(axis));
      gaps2_(0, axis) = (half + aside) * (half + aside);
      gaps2_(1, axis) = 0.0F;
      gaps2_(2, axis) = (half - aside) * (half - aside);
    }
  }

  /// From its voxel to another, along the axes of the map [voxels].
  Eigen::Vector3i voxels_to(const Offset& offset) const {
    return side_.cwiseProduct(Eigen::Vector3i(offset.x, offset.y, offset.z));
  }
  /// From the middle of a voxel to the query.
  Eigen::Vector3f from_middle_of(const Offset& offset) const {
    return from_middle_ - voxels_to(offset).cast<float>() * static_cast<float>(kStepsPerVoxel);
  }
  /// To the nearest place in a voxel.
  float squared_distance_to(const Offset& offset) const {
    return gaps2_(offset.x + 1, 0) + gaps2_(offset.y + 1, 1) + gaps2_(offset.z + 1, 2);
  }
  /// To the nearest of all but the first kNear of the voxels.
  float squared_distance_to_others() const { return gaps2_.row(0).minCoeff(); }

 private:
  Eigen::Vector3f from_middle_;
  Eigen::Vector3i side_;
  Eigen::Matrix3f gaps2_;  // along each axis (columns) by a step of -1, 0 and 1
};

/// A point near a query as one number, ordered by distance: the bits of the squared distance, the last of
/// which give way to where the point is. It leaves 13 bits to the fraction.
class NearKey {
 public:
  /// Farther than any point.
  static constexpr std::int32_t kNone = std::bit_cast<std::int32_t>(std::numeric_limits<float>::max());

  /// @param neighbour  of the point's voxel in kNeighbours
  /// @param point      in its voxel, below 32
  static std::int32_t of(float squared_distance, std::size_t neighbour, std::size_t point) {
    const auto place = static_cast<std::int32_t>(neighbour << kPointBits | point);
    return (std::bit_cast<std::int32_t>(squared_distance) & ~kPlaceMask) | place;
  }
  static std::size_t neighbour(std::int32_t key) {
    return static_cast<std::size_t>((key & kPlaceMask) >> kPointBits);
  }
  static std::size_t point(std::int32_t key) { return static_cast<std::size_t>(key & kPointMask); }
  /// Not below the squared distance that it was made of.
  static float squared_distance_bound(std::int32_t key) { return std::bit_cast<float>(key | kPlaceMask); }

 private:
  static constexpr int kPointBits = 5;
  static constexpr std::int32_t kPointMask = (1 << kPointBits) - 1;
  static constexpr std::int32_t kPlaceMask = (1 << 2 * kPointBits) - 1;
};

/// The eight smallest of some keys, in ascending order; NearKey::kNone where there were fewer.
class SmallestKeys {
 public:
  static constexpr int kCount = 8;

  /// Without a branch, as none could be foretold: the key goes past all that are smaller.
  void add(std::int32_t key) {
    const Keys before = __builtin_shufflevector(keys_, Keys{}, 8, 0, 1, 2, 3, 4, 5, 6);
    const Keys added = Keys{} + key;
    const Keys larger = before > added ? before : added;
    keys_ = keys_ < larger ? keys_ : larger;
  }
  std::int32_t operator[](int i) const { return keys_[i]; }

 private:
  using Keys [[gnu::vector_size(4 * kCount)]] = std::int32_t;

  Keys keys_ = Keys{} + NearKey::kNone;
};

}  // namespace mlo
