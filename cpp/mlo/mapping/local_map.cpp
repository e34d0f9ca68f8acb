#include "mlo/mapping/local_map.hpp"

#include <algorithm>
#include <cmath>

namespace mlo {
namespace {

// The map is searched for what to forget each time the robot has moved by this share of the radius.
constexpr double kForgetEvery = 0.05;

struct Offset {
  int x, y, z;
};

// The 27 voxels around a query, by their number of steps: near ones first, so that the others are often
// farther than the k points already found.
constexpr std::array<Offset, 27> neighbour_offsets() {
  std::array<Offset, 27> offsets{};
  std::size_t n = 0;
  for (int steps = 0; steps <= 3; ++steps) {
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          if (x * x + y * y + z * z == steps) offsets[n++] = {x, y, z};
        }
      }
    }
  }
  return offsets;
}
constexpr std::array<Offset, 27> kNeighbours = neighbour_offsets();

// Squared distance along one axis from a query at `fraction` of its voxel to the voxel `step` further.
float axis_distance2(float fraction, int step) {
  if (step == 0) return 0.0F;
  const float d = step > 0 ? 1.0F - fraction : fraction;
  return d * d;
}

void keep_nearest(const Eigen::Vector3f& point, float d2, int k, NearestPoints& nearest) {
  if (nearest.count == k && d2 >= nearest.squared_distances_m2[static_cast<std::size_t>(k - 1)]) return;
  int i = nearest.count < k ? nearest.count++ : k - 1;
  for (; i > 0 && nearest.squared_distances_m2[static_cast<std::size_t>(i - 1)] > d2; --i) {
    nearest.points[static_cast<std::size_t>(i)] = nearest.points[static_cast<std::size_t>(i - 1)];
    nearest.squared_distances_m2[static_cast<std::size_t>(i)] =
        nearest.squared_distances_m2[static_cast<std::size_t>(i - 1)];
  }
  nearest.points[static_cast<std::size_t>(i)] = point;
  nearest.squared_distances_m2[static_cast<std::size_t>(i)] = d2;
}

}  // namespace

LocalMap::LocalMap(const LocalMapConfig& config)
    : config_(config), inverse_voxel_(static_cast<float>(1.0 / config.voxel_m)) {}

void LocalMap::insert(std::span<const Eigen::Vector3f> points_map) {
  const auto spacing2 = static_cast<float>(config_.min_spacing_m * config_.min_spacing_m);
  const auto capacity = static_cast<std::uint32_t>(config_.max_points_per_voxel);
  for (const Eigen::Vector3f& p : points_map) {
    const auto [entry, is_new] = index_.try_emplace(voxel_key(p, inverse_voxel_), 0U);
    if (is_new) entry.value() = take_voxel();
    Voxel& home = voxel(entry->second);
    if (home.count >= capacity) continue;
    const auto end = home.points.begin() + home.count;
    if (std::any_of(home.points.begin(), end,
                    [&](const Eigen::Vector3f& q) { return (p - q).squaredNorm() < spacing2; })) {
      continue;
    }
    home.points[home.count++] = p;
  }
}

std::uint32_t LocalMap::take_voxel() {
  if (!free_.empty()) {
    const std::uint32_t place = free_.back();
    free_.pop_back();
    return place;
  }
  if (num_taken_ >> kBlockBits == blocks_.size()) blocks_.emplace_back(std::size_t{1} << kBlockBits);
  return num_taken_++;
}

void LocalMap::forget_beyond_radius(const Eigen::Vector3f& center_map) {
  const double moved_m = (center_map - last_center_map_).cast<double>().norm();
  if (moved_m < kForgetEvery * config_.radius_m) return;
  last_center_map_ = center_map;
  const VoxelKey center = voxel_key(center_map, inverse_voxel_);
  const double radius_voxels = config_.radius_m / config_.voxel_m;
  for (auto it = index_.begin(); it != index_.end();) {
    // By the keys alone: the points lie elsewhere in memory.
    const VoxelKey& key = it->first;
    const Eigen::Vector3d steps(key.x - center.x, key.y - center.y, key.z - center.z);
    if (steps.squaredNorm() <= radius_voxels * radius_voxels) {
      ++it;
      continue;
    }
    voxel(it->second).count = 0;
    free_.push_back(it->second);
    it = index_.erase(it);
  }
}

NearestPoints LocalMap::nearest(const Eigen::Vector3f& query_map, int k, float gate_m) const {
  NearestPoints nearest;
  const VoxelKey key = voxel_key(query_map, inverse_voxel_);
  const Eigen::Vector3f scaled = query_map * inverse_voxel_;
  const Eigen::Vector3f fraction = scaled - scaled.array().floor().matrix();
  const auto voxel2 = static_cast<float>(config_.voxel_m * config_.voxel_m);
  const float gate2 = gate_m * gate_m;
  for (const Offset& step : kNeighbours) {
    const float voxel_d2 = voxel2 * (axis_distance2(fraction.x(), step.x) +
                                     axis_distance2(fraction.y(), step.y) +
                                     axis_distance2(fraction.z(), step.z));
    const float worst = nearest.count == k ? nearest.squared_distances_m2[static_cast<std::size_t>(k - 1)]
                                           : std::numeric_limits<float>::max();
    if (voxel_d2 >= worst) continue;
    const auto found = index_.find({key.x + step.x, key.y + step.y, key.z + step.z});
    if (found == index_.end()) continue;
    const Voxel& near = voxel(found->second);
    for (std::uint32_t i = 0; i < near.count; ++i) {
      keep_nearest(near.points[i], (near.points[i] - query_map).squaredNorm(), k, nearest);
    }
  }
  if (nearest.count > 0 && nearest.squared_distances_m2[0] > gate2) nearest.count = 0;
  return nearest;
}

void LocalMap::clear() {
  index_.clear();
  blocks_.clear();
  num_taken_ = 0;
  free_.clear();
  last_center_map_.setZero();
}

}  // namespace mlo
