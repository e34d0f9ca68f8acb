#include "mlo/scene/scene_writer.hpp"

#include <utility>

#include "mlo/core/archive.hpp"
#include "mlo/core/bytes.hpp"
#include "mlo/core/voxel_grid.hpp"
#include "mlo/scene/cloud_codec.hpp"

namespace mlo {
namespace {

constexpr float kTile_m = 20.0F;
// Powers of two, so that coordinates are exact in single precision.
constexpr double kCloudStep_m = 1.0 / 256.0;
constexpr double kMapStep_m = 1.0 / 1024.0;  // of objects, too

std::uint64_t tile_number(const Eigen::Vector3f& p_map) {
  const VoxelKey key = voxel_key(p_map, 1.0F / kTile_m);
  return std::uint64_t{static_cast<std::uint32_t>(key.x)} << 32U | static_cast<std::uint32_t>(key.y);
}

std::map<std::uint64_t, SceneCloud> split_into_tiles(std::span<const MapPoint> points) {
  std::map<std::uint64_t, SceneCloud> tiles;
  for (const MapPoint& point : points) {
    tiles[tile_number(point.p_map)].add({point.p_map, point.intensity}, point.label);
  }
  return tiles;
}

// Whole metres in the middle, so that 16 bits reach far to all sides.
Eigen::Vector3d origin_of(const SceneCloud& tile) {
  if (tile.points.empty()) return Eigen::Vector3d::Zero();
  Eigen::AlignedBox3f box;
  for (const ScenePoint& point : tile.points) box.extend(point.p);
  return box.center().cast<double>().array().round();
}

}  // namespace

SceneWriter::SceneWriter(const std::filesystem::path& path, const SceneMeta& meta, const SceneConfig& config)
    : file_(path, config.compression_level) {
  ArchiveWriter bytes;
  bytes(meta);
  file_.append({.type = ChunkType::meta}, bytes.bytes());
}

SceneWriter::SceneWriter(const std::filesystem::path& path, SceneWriterState state, const SceneConfig& config)
    : file_(path, config.compression_level, std::move(state.chunks)),
      last_stamp_s_(state.last_stamp_s),
      tile_checksums_(std::move(state.tile_checksums)) {}

void SceneWriter::write(const SceneScan& scan, const SceneCloud* cloud) {
  ChunkInfo info{.type = ChunkType::cloud, .number = scan.frame};
  info.first_stamp_s = info.last_stamp_s = last_stamp_s_ = scan.stamp_s;
  // The scan last: where it is, its cloud is too.
  if (cloud != nullptr && !cloud->points.empty()) {
    file_.append(info, encode_cloud(*cloud, Eigen::Vector3d::Zero(), kCloudStep_m));
  }
  info.type = ChunkType::scan;
  ArchiveWriter bytes;
  bytes(scan);
  file_.append(info, bytes.bytes());
}

void SceneWriter::write_map(std::span<const MapPoint> points) {
  std::map<std::uint64_t, SceneCloud> tiles = split_into_tiles(points);
  for (const auto& [number, checksum] : tile_checksums_) tiles.try_emplace(number);  // empty by now
  for (const auto& [number, tile] : tiles) {
    const std::string bytes = encode_cloud(tile, origin_of(tile), kMapStep_m);
    const std::uint32_t checksum = crc32(bytes);
    const auto [written, is_new] = tile_checksums_.try_emplace(number, checksum);
    if (!is_new && written->second == checksum) continue;
    written->second = checksum;
    file_.append({.type = ChunkType::map_tile,
                  .number = number,
                  .first_stamp_s = last_stamp_s_,
                  .last_stamp_s = last_stamp_s_},
                 bytes);
  }
}

void SceneWriter::write_object(long id, const SceneCloud& cloud) {
  file_.append({.type = ChunkType::object,
                .number = static_cast<std::uint64_t>(id),
                .first_stamp_s = last_stamp_s_,
                .last_stamp_s = last_stamp_s_},
               encode_cloud(cloud, Eigen::Vector3d::Zero(), kMapStep_m));
}

void SceneWriter::finish() {
  file_.finish();
}

}  // namespace mlo
