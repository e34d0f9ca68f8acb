#include "mlo/mapping/static_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

constexpr float kTileM = 20.0F;

VoxelKey tile_key(const Eigen::Vector3f& p_map) {
  VoxelKey key = voxel_key(p_map, 1.0F / kTileM);
  key.z = 0;
  return key;
}

}  // namespace

StaticMap::StaticMap(const StaticMapConfig& config)
    : config_(config), inverse_voxel_(static_cast<float>(1.0 / config.voxel_m)) {}

void StaticMap::insert(const Percept& percept, const SweepMotion& motion, const SE3& T_map_lidar) {
  insert(percept.edge.candidates, MapLabel::edge, motion, T_map_lidar);
  insert(percept.ground.candidates, MapLabel::ground, motion, T_map_lidar);
  insert(percept.surface.candidates, MapLabel::surface, motion, T_map_lidar);
}

void StaticMap::insert(std::span<const FeaturePoint> features, MapLabel label, const SweepMotion& motion,
                       const SE3& T_map_lidar) {
  for (const FeaturePoint& feature : features) {
    const Eigen::Vector3d p_lidar =
        motion.undistort(feature.p_lidar.cast<double>(), static_cast<double>(feature.sweep_fraction));
    const Eigen::Vector3f p_map = (T_map_lidar * p_lidar).cast<float>();
    const VoxelKey key = tile_key(p_map);
    const auto [found, is_new_tile] = tile_index_.try_emplace(key, static_cast<std::uint32_t>(tiles_.size()));
    if (is_new_tile) {
      tiles_.emplace_back();
      tile_keys_.push_back(key);
    }
    Tile& tile = tiles_[found->second];
    const auto next = static_cast<std::uint32_t>(tile.entries.size());
    const auto [place, is_new] = tile.index.try_emplace(voxel_key(p_map, inverse_voxel_), next);
    if (is_new) tile.entries.push_back({{p_map, feature.intensity, label}});
  }
}

void StaticMap::observe(const RangeImage& view, const SweepMotion& motion, const SE3& T_map_lidar) {
  const Eigen::Vector3f center = T_map_lidar.translation().cast<float>();
  const double reach_m = config_.free_space_range_m + static_cast<double>(kTileM);
  std::vector<std::uint32_t> near;
  for (std::uint32_t i = 0; i < tiles_.size(); ++i) {
    const Eigen::Vector2f middle((static_cast<float>(tile_keys_[i].x) + 0.5F) * kTileM,
                                 (static_cast<float>(tile_keys_[i].y) + 0.5F) * kTileM);
    if ((middle - center.head<2>()).norm() <= static_cast<float>(reach_m)) near.push_back(i);
  }
  const SE3 T_lidar_map = T_map_lidar.inverse();
  parallel_for_each_index(near.size(),
                          [&](std::size_t i) { observe(tiles_[near[i]], view, motion, T_lidar_map); });
}

void StaticMap::observe(Tile& tile, const RangeImage& view, const SweepMotion& motion,
                        const SE3& T_lidar_map) const {
  const double range2 = config_.free_space_range_m * config_.free_space_range_m;
  for (Entry& entry : tile.entries) {
    const Eigen::Vector3d p_lidar = T_lidar_map * entry.point.p_map.cast<double>();
    if (p_lidar.squaredNorm() > range2) continue;
    const Eigen::Vector3d p_measured = motion.distort(p_lidar, view.sweep_fraction(p_lidar));
    double margin_m = config_.free_space_margin_m + config_.free_space_margin_per_range * p_lidar.norm();
    if (entry.point.label == MapLabel::ground) margin_m += view.step_on_ground_m(p_lidar);
    const Sight sight = view.look(p_measured, margin_m);
    const auto limit = static_cast<float>(config_.free_space_max_votes);
    if (sight == Sight::hit) {
      entry.votes = std::min(entry.votes + static_cast<float>(config_.free_space_hit_votes), limit);
    } else if (sight == Sight::through) {
      entry.votes = std::max(entry.votes - 1.0F, -limit);
    }
  }
}

std::size_t StaticMap::size() const {
  std::size_t size = 0;
  for (const Tile& tile : tiles_) size += tile.entries.size();
  return size;
}

std::vector<MapPoint> StaticMap::points() const {
  std::vector<MapPoint> all;
  all.reserve(size());
  for (const Tile& tile : tiles_) {
    for (const Entry& entry : tile.entries) {
      if (!is_seen_through(entry)) all.push_back(entry.point);
    }
  }
  return all;
}

}  // namespace mlo
