#include "mlo/mapping/local_map.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "mlo/mapping/voxel_search.hpp"

namespace mlo {
namespace {

// The map is searched for what to forget each time the robot has moved by this share of the radius.
constexpr double kForgetEvery = 0.05;
// So many points wait for the memory of their voxels together.
constexpr std::size_t kInsertedAtOnce = 16;

}  // namespace

LocalMap::LocalMap(const LocalMapConfig& config)
    : config_(config),
      inverse_voxel_(static_cast<float>(1.0 / config.voxel_m)),
      step_m_(static_cast<float>(config.voxel_m / kStepsPerVoxel)) {}

Eigen::Vector3f LocalMap::middle(const VoxelKey& key) const {
  return (Eigen::Vector3i(key.x, key.y, key.z).cast<double>().array() + 0.5).matrix().cast<float>() *
         static_cast<float>(config_.voxel_m);
}

inline std::array<float, LocalMap::Voxel::kLanes> LocalMap::Voxel::squared_distances(
    const Eigen::Vector3f& p) const {
  std::array<float, kLanes> distances2;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float dx = static_cast<float>(data[i]) - p.x();
    const float dy = static_cast<float>(data[kMaxPoints + i]) - p.y();
    const float dz = static_cast<float>(data[2 * kMaxPoints + i]) - p.z();
    distances2[i] = dx * dx + dy * dy + dz * dz;
  }
  return distances2;
}

std::vector<std::uint8_t> LocalMap::insert(std::span<const Eigen::Vector3f> points_map) {
  struct Home {
    Voxel* voxel = nullptr;
    Eigen::Vector3f steps;  // from its middle
  };
  std::array<Home, kInsertedAtOnce> homes;
  VoxelBlock* block = nullptr;
  VoxelKey last_block;
  const auto home_of = [&](const Eigen::Vector3f& p) -> Home {
    const VoxelKey key = voxel_key(p, inverse_voxel_);
    // Neighbours in a scan are neighbours in the map.
    if (block == nullptr || VoxelBlock::key_of(key) != last_block) {
      last_block = VoxelBlock::key_of(key);
      block = &blocks_[last_block];
    }
    std::uint32_t& place = block->at(key);
    if (place == VoxelBlock::kNone) place = take_voxel();
    return {&voxel(place), (p - middle(key)) / step_m_};
  };

  std::vector<std::uint8_t> added(points_map.size(), 0);
  for (std::size_t first = 0; first < points_map.size(); first += homes.size()) {
    const std::size_t size = std::min(homes.size(), points_map.size() - first);
    for (std::size_t i = 0; i < size; ++i) {
      homes[i] = home_of(points_map[first + i]);
      homes[i].voxel->prefetch();
    }
    for (std::size_t i = 0; i < size; ++i) {
      if (!has_room(*homes[i].voxel, homes[i].steps)) continue;
      homes[i].voxel->push_back(homes[i].steps);
      added[first + i] = 1;
    }
  }
  return added;
}

// For another point, at a place in steps from the voxel's middle.
bool LocalMap::has_room(const Voxel& voxel, const Eigen::Vector3f& steps) const {
  if (voxel.count() >= static_cast<std::size_t>(config_.max_points_per_voxel)) return false;
  const auto spacing = static_cast<float>(config_.min_spacing_m) / step_m_;
  const auto distances2 = voxel.squared_distances(steps);
  const auto end = std::next(distances2.begin(), static_cast<std::ptrdiff_t>(voxel.count()));
  return std::none_of(distances2.begin(), end, [&](float d2) { return d2 < spacing * spacing; });
}

void LocalMap::Voxel::push_back(const Eigen::Vector3f& p) {
  const auto rounded = [](float steps) {
    constexpr float lowest = std::numeric_limits<std::int16_t>::min();
    constexpr float highest = std::numeric_limits<std::int16_t>::max();
    return static_cast<std::int16_t>(std::lround(std::clamp(steps, lowest, highest)));
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    data[axis * kMaxPoints + count()] = rounded(p(static_cast<Eigen::Index>(axis)));
  }
  ++data[3 * kMaxPoints];
}

Eigen::Vector3f LocalMap::Voxel::point(std::size_t i) const {
  return Eigen::Matrix<std::int16_t, 3, 1>(data[i], data[kMaxPoints + i], data[2 * kMaxPoints + i])
      .cast<float>();
}

std::uint32_t LocalMap::take_voxel() {
  ++num_voxels_;
  if (!free_.empty()) {
    const std::uint32_t place = free_.back();
    free_.pop_back();
    return place;
  }
  if (num_taken_ >> kPoolBits == pools_.size()) pools_.emplace_back(std::size_t{1} << kPoolBits);
  return num_taken_++;
}

void LocalMap::forget_beyond_radius(const Eigen::Vector3f& center_map) {
  const double moved_m = (center_map - last_center_map_).cast<double>().norm();
  if (moved_m < kForgetEvery * config_.radius_m) return;
  last_center_map_ = center_map;
  const VoxelKey center = voxel_key(center_map, inverse_voxel_);
  const double radius_voxels = config_.radius_m / config_.voxel_m;
  for (auto it = blocks_.begin(); it != blocks_.end();) {
    const bool is_empty = forget_beyond(it->first, it.value(), center, radius_voxels);
    it = is_empty ? blocks_.erase(it) : std::next(it);
  }
}

// By the keys alone: the points lie elsewhere in memory. True when nothing is left of the block.
bool LocalMap::forget_beyond(const VoxelKey& block_key, VoxelBlock& block, const VoxelKey& center,
                             double radius_voxels) {
  bool is_empty = true;
  for (int x = 0; x < VoxelBlock::kSide; ++x) {
    for (int y = 0; y < VoxelBlock::kSide; ++y) {
      for (int z = 0; z < VoxelBlock::kSide; ++z) {
        const VoxelKey key{block_key.x * VoxelBlock::kSide + x, block_key.y * VoxelBlock::kSide + y,
                           block_key.z * VoxelBlock::kSide + z};
        std::uint32_t& place = block.at(key);
        if (place == VoxelBlock::kNone) continue;
        const Eigen::Vector3d steps(key.x - center.x, key.y - center.y, key.z - center.z);
        if (steps.squaredNorm() <= radius_voxels * radius_voxels) {
          is_empty = false;
          continue;
        }
        voxel(place).clear();
        free_.push_back(place);
        place = VoxelBlock::kNone;
        --num_voxels_;
      }
    }
  }
  return is_empty;
}

// The voxels around a place, with the blocks that were already looked up.
class LocalMap::Neighbourhood {
 public:
  Neighbourhood(const LocalMap& map, const VoxelKey& center)
      : map_(map), center_(center), center_block_(VoxelBlock::key_of(center)) {}

  /// The voxel some steps (-1, 0 or 1 along each axis) from the centre, if it exists.
  const Voxel* find(const Eigen::Vector3i& step) {
    const VoxelKey key{center_.x + step.x(), center_.y + step.y(), center_.z + step.z()};
    const VoxelBlock* block = find_block(VoxelBlock::key_of(key));
    if (block == nullptr) return nullptr;
    const std::uint32_t place = block->at(key);
    return place == VoxelBlock::kNone ? nullptr : &map_.voxel(place);
  }

 private:
  const VoxelBlock* find_block(const VoxelKey& key) {
    const int index = ((key.x - center_block_.x + 1) * 3 + (key.y - center_block_.y + 1)) * 3 +
                      (key.z - center_block_.z + 1);
    const auto bit = std::uint32_t{1} << index;
    const VoxelBlock*& block = known_blocks_[static_cast<std::size_t>(index)];
    if ((known_ & bit) == 0) {
      known_ |= bit;
      const auto found = map_.blocks_.find(key);
      block = found == map_.blocks_.end() ? nullptr : &found->second;
    }
    return block;
  }

  const LocalMap& map_;
  VoxelKey center_;
  VoxelKey center_block_;
  std::uint32_t known_ = 0;  // a bit for each of known_blocks_
  std::array<const VoxelBlock*, 27> known_blocks_;
};

NearestPoints LocalMap::nearest(const Eigen::Vector3f& query_map, int k, float gate_m) const {
  const VoxelKey key = voxel_key(query_map, inverse_voxel_);
  const Eigen::Vector3f query = (query_map - middle(key)) / step_m_;
  const InVoxel in_voxel(query);
  Neighbourhood around(*this, key);
  SmallestKeys nearest;
  std::array<const Voxel*, kNeighbours.size()> voxels;
  for (std::size_t n = 0; n < kNear; ++n) {
    voxels[n] = around.find(in_voxel.voxels_to(kNeighbours[n]));
    if (voxels[n] != nullptr) voxels[n]->prefetch();
  }
  float worst = NearKey::squared_distance_bound(nearest[k - 1]);
  for (std::size_t n = 0; n < kNeighbours.size(); ++n) {
    if (n == kNear && in_voxel.squared_distance_to_others() >= worst) break;
    if (in_voxel.squared_distance_to(kNeighbours[n]) >= worst) continue;
    if (n >= kNear) voxels[n] = around.find(in_voxel.voxels_to(kNeighbours[n]));
    if (voxels[n] == nullptr) continue;
    const auto distances2 = voxels[n]->squared_distances(in_voxel.from_middle_of(kNeighbours[n]));
    std::array<std::int32_t, Voxel::kLanes> keys;
    for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = NearKey::of(distances2[i], n, i);
    for (std::size_t i = 0; i < voxels[n]->count(); ++i) nearest.add(keys[i]);
    worst = NearKey::squared_distance_bound(nearest[k - 1]);
  }

  NearestPoints result;
  for (int i = 0; i < k && nearest[i] != NearKey::kNone; ++i) {
    const std::size_t n = NearKey::neighbour(nearest[i]);
    const Eigen::Vector3f to_point =
        (voxels[n]->point(NearKey::point(nearest[i])) - in_voxel.from_middle_of(kNeighbours[n])) * step_m_;
    const auto place = static_cast<std::size_t>(result.count++);
    result.points[place] = query_map + to_point;
    result.squared_distances_m2[place] = to_point.squaredNorm();
  }
  if (result.count > 0 && result.squared_distances_m2[0] > gate_m * gate_m) result.count = 0;
  return result;
}

void LocalMap::clear() {
  blocks_.clear();
  pools_.clear();
  num_voxels_ = 0;
  num_taken_ = 0;
  free_.clear();
  last_center_map_.setZero();
}

}  // namespace mlo
