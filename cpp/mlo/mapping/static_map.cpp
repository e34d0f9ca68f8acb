#include "mlo/mapping/static_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

constexpr float kTileM = 20.0F;
// Where so many points of a block were seen through, those that were hardly seen are taken for part of the
// same thing that passed.
constexpr float kBlockM = 1.0F;
constexpr int kDoubtfulBlock = 3;
// So many scans in a row have to see the sky at a place, no hit between them, until it counts as free.
constexpr std::uint8_t kSkies = 3;
// Votes of an entry that was taken back: for ever out of the map.
constexpr float kTakenBack = -std::numeric_limits<float>::infinity();

VoxelKey block_key(const Eigen::Vector3f& p_map) {
  return voxel_key(p_map, 1.0F / kBlockM);
}

VoxelKey tile_key(const Eigen::Vector3f& p_map) {
  VoxelKey key = voxel_key(p_map, 1.0F / kTileM);
  key.z = 0;
  return key;
}

// From a place to the tile; 0 within it.
float distance_m(const VoxelKey& tile, const Eigen::Vector3f& p_map) {
  const Eigen::Array2f low(static_cast<float>(tile.x) * kTileM, static_cast<float>(tile.y) * kTileM);
  const Eigen::Array2f p = p_map.head<2>().array();
  return (low - p).max(p - low - kTileM).max(0.0F).matrix().norm();
}

}  // namespace

StaticMap::StaticMap(const StaticMapConfig& config, const FreeSpaceConfig& free_space)
    : config_(config), free_space_(free_space), inverse_voxel_(static_cast<float>(1.0 / config.voxel_m)) {}

void StaticMap::insert(std::span<const MapPoint> points, std::size_t frame, const LeftOut& left_out) {
  const PointsOfTiles by_tile = by_tiles(points, left_out);
  std::vector<std::uint32_t> places;
  for (const auto& [place, chosen] : by_tile) places.push_back(place);
  parallel_for_each_index(places.size(), [&](std::size_t i) {
    insert(tiles_[places[i]], points, by_tile.at(places[i]), static_cast<std::uint32_t>(frame));
  });
}

bool StaticMap::is_left_out(const MapPoint& point, const LeftOut& left_out, const SE3& T_lidar_map) const {
  if (point.label != MapLabel::ground && left_out.columns.contains(point.p_map)) return true;
  if (left_out.moving.empty()) return false;
  const Eigen::Vector3d p_lidar = T_lidar_map * point.p_map.cast<double>();
  return std::ranges::any_of(
      left_out.moving, [&](const Box3d& box) { return box.contains(p_lidar, config_.moving_margin_m); });
}

StaticMap::PointsOfTiles StaticMap::by_tiles(std::span<const MapPoint> points, const LeftOut& left_out) {
  const SE3 T_lidar_map = left_out.T_map_lidar.inverse();
  PointsOfTiles by_tile;
  std::vector<std::uint32_t>* chosen = nullptr;
  VoxelKey last_tile;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (is_left_out(points[i], left_out, T_lidar_map)) continue;
    // Neighbours in a scan are neighbours in the map.
    const VoxelKey tile = tile_key(points[i].p_map);
    if (chosen == nullptr || tile != last_tile) chosen = &by_tile[tile_at(tile)];
    last_tile = tile;
    chosen->push_back(i);
  }
  return by_tile;
}

void StaticMap::insert(Tile& tile, std::span<const MapPoint> points, std::span<const std::uint32_t> chosen,
                       std::uint32_t frame) const {
  VoxelBlock* block = nullptr;
  VoxelKey last_block;
  for (const std::uint32_t i : chosen) {
    const VoxelKey voxel = voxel_key(points[i].p_map, inverse_voxel_);
    if (block == nullptr || VoxelBlock::key_of(voxel) != last_block) {
      last_block = VoxelBlock::key_of(voxel);
      block = &tile.index[last_block];
    }
    std::uint32_t& place = block->at(voxel);
    if (place != VoxelBlock::kNone) continue;
    place = static_cast<std::uint32_t>(tile.entries.size());
    tile.entries.push_back({.point = points[i], .frame = frame});
  }
}

// Returns its place in tiles_. It is in memory then.
std::uint32_t StaticMap::tile_at(const VoxelKey& key) {
  const auto [found, is_new] = tile_index_.try_emplace(key, static_cast<std::uint32_t>(tiles_.size()));
  if (is_new) tiles_.emplace_back().key = key;
  Tile& tile = tiles_[found->second];
  if (tile.num_spooled > 0) fetch(tile);
  return found->second;
}

void StaticMap::fetch(Tile& tile) const {
  tile.entries = entries_of(tile);
  tile.num_spooled = 0;
  make_index(tile);
}

void StaticMap::make_index(Tile& tile) const {
  for (std::uint32_t i = 0; i < tile.entries.size(); ++i) {
    if (tile.entries[i].votes == kTakenBack) continue;
    const VoxelKey voxel = voxel_key(tile.entries[i].point.p_map, inverse_voxel_);
    tile.index[VoxelBlock::key_of(voxel)].at(voxel) = i;
  }
}

std::vector<StaticMap::Entry> StaticMap::entries_of(const Tile& tile) const {
  if (tile.num_spooled == 0) return tile.entries;
  std::vector<Entry> entries(tile.num_spooled);
  spool_.read(tile.place, std::as_writable_bytes(std::span(entries)));
  return entries;
}

void StaticMap::spool_far(const Eigen::Vector3f& center_map) {
  for (Tile& tile : tiles_) {
    if (tile.entries.empty() ||
        distance_m(tile.key, center_map) <= static_cast<float>(config_.memory_radius_m))
      continue;
    spool(tile);
  }
}

void StaticMap::spool(Tile& tile) {
  tile.place = spool_.write(std::as_bytes(std::span(tile.entries)));
  tile.num_spooled = tile.entries.size();
  tile.entries = {};
  tile.index = {};
}

void StaticMap::observe(const ScanView& view) {
  std::vector<Tile*> near;
  for (Tile& tile : tiles_) {
    const bool in_reach = distance_m(tile.key, view.center_map()) <= static_cast<float>(free_space_.range_m);
    if (in_reach && tile.num_spooled == 0) near.push_back(&tile);
  }
  parallel_for_each_index(near.size(), [&](std::size_t i) { observe(*near[i], view); });
}

void StaticMap::observe(Tile& tile, const ScanView& view) const {
  for (Entry& entry : tile.entries) {
    if (entry.votes == kTakenBack) continue;
    vote(entry, view.look(entry.point.p_map, entry.point.label == MapLabel::ground, free_space_));
  }
}

void StaticMap::vote(Entry& entry, Sight sight) const {
  const auto limit = static_cast<float>(config_.max_votes);
  if (sight == Sight::hit) {
    entry.skies = 0;
    entry.votes = std::min(entry.votes + static_cast<float>(config_.hit_votes), limit);
    return;
  }
  // From the road, and now and then from anything, nothing comes back though it is there.
  if (sight == Sight::sky && entry.point.label != MapLabel::ground && entry.skies < kSkies) ++entry.skies;
  const bool is_free = sight == Sight::through || (sight == Sight::sky && entry.skies == kSkies);
  if (is_free) entry.votes = std::max(entry.votes - 1.0F, -limit);
}

void StaticMap::take_back(std::size_t frame, const SE3& T_map_object, const Eigen::Vector3d& size_lwh_m) {
  const SE3 T_object_map = T_map_object.inverse();
  const Eigen::Array3d half_m = 0.5 * size_lwh_m.array() + config_.moving_margin_m;
  const auto is_inside = [&](const Eigen::Vector3f& p_map) {
    return ((T_object_map * p_map.cast<double>()).array().abs() <= half_m).all();
  };
  const Eigen::Vector3f center_map = T_map_object.translation().cast<float>();
  const auto reach_m = static_cast<float>(half_m.head<2>().matrix().norm());
  const VoxelKey low = tile_key(center_map - Eigen::Vector3f(reach_m, reach_m, 0.0F));
  const VoxelKey high = tile_key(center_map + Eigen::Vector3f(reach_m, reach_m, 0.0F));
  for (int x = low.x; x <= high.x; ++x) {
    for (int y = low.y; y <= high.y; ++y) {
      const auto found = tile_index_.find({x, y, 0});
      if (found != tile_index_.end()) take_back(tiles_[found->second], frame, is_inside);
    }
  }
}

template <class IsInside>
void StaticMap::take_back(Tile& tile, std::size_t frame, const IsInside& is_inside) {
  // The entries of a tile are in the order of the scans.
  const auto is_earlier = [](const Entry& entry, std::size_t than) { return entry.frame < than; };
  auto entry = std::lower_bound(tile.entries.begin(), tile.entries.end(), frame, is_earlier);
  for (; entry != tile.entries.end() && entry->frame == frame; ++entry) {
    if (entry->votes == kTakenBack || !is_inside(entry->point.p_map)) continue;
    entry->votes = kTakenBack;
    const VoxelKey voxel = voxel_key(entry->point.p_map, inverse_voxel_);
    tile.index[VoxelBlock::key_of(voxel)].at(voxel) = VoxelBlock::kNone;
  }
}

void StaticMap::archive(const StaticMap& self, ArchiveWriter& bytes) {
  bytes(self.tiles_.size());
  for (const Tile& tile : self.tiles_) bytes(tile.key, tile.num_spooled > 0, self.entries_of(tile));
}

void StaticMap::archive(StaticMap& self, ArchiveReader& bytes) {
  self = StaticMap(self.config_, self.free_space_);
  std::size_t count = 0;
  bytes(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    Tile& tile = self.tiles_.emplace_back();
    bool spooled = false;
    bytes(tile.key, spooled, tile.entries);
    self.tile_index_.emplace(tile.key, i);
    // What is on disk takes no part in votes before it is fetched: it has to be there again.
    if (spooled) {
      self.spool(tile);
    } else {
      self.make_index(tile);
    }
  }
}

std::size_t StaticMap::size() const {
  std::size_t size = 0;
  for (const Tile& tile : tiles_) size += std::max(tile.entries.size(), tile.num_spooled);
  return size;
}

StaticMap::Counts StaticMap::count_seen_through() const {
  Counts counts;
  for (const Tile& tile : tiles_) {
    for (const Entry& entry : entries_of(tile)) {
      if (is_seen_through(entry)) ++counts[block_key(entry.point.p_map)];
    }
  }
  return counts;
}

template <class Use>
void StaticMap::for_each_kept(const Use& use) const {
  const Counts seen_through = count_seen_through();
  const auto is_doubtful = [&](const Entry& entry) {
    if (static_cast<double>(entry.votes) >= config_.sure_votes) return false;
    const auto found = seen_through.find(block_key(entry.point.p_map));
    return found != seen_through.end() && found->second >= kDoubtfulBlock;
  };
  for (const Tile& tile : tiles_) {
    for (const Entry& entry : entries_of(tile)) {
      if (!is_seen_through(entry) && !is_doubtful(entry)) use(entry);
    }
  }
}

std::vector<MapPoint> StaticMap::points() const {
  return moved_points({});
}

std::vector<MapPoint> StaticMap::moved_points(const std::map<std::size_t, SE3>& corrections) const {
  std::vector<MapPoint> points;
  points.reserve(size());
  for_each_kept([&](const Entry& entry) {
    points.push_back(entry.point);
    const auto correction = corrections.find(entry.frame);
    if (correction == corrections.end()) return;
    Eigen::Vector3f& p_map = points.back().p_map;
    p_map = (correction->second * p_map.cast<double>()).cast<float>();
  });
  if (corrections.empty()) return points;
  return downsample_first<MapPoint>(points, static_cast<float>(config_.voxel_m),
                                    [](const MapPoint& point) { return point.p_map; });
}

}  // namespace mlo
