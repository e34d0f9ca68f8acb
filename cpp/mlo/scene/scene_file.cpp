#include "mlo/scene/scene_file.hpp"

#include "mlo/core/archive.hpp"
#include "mlo/scene/cloud_codec.hpp"

namespace mlo {

SceneFile::SceneFile(const std::filesystem::path& path) : file_(path) {
  for (const IndexedChunk& chunk : file_.chunks()) {
    switch (chunk.info.type) {
      case ChunkType::meta:
        meta_ = read<SceneMeta>(chunk);
        break;
      case ChunkType::scan:
        scans_.push_back(chunk);
        break;
      case ChunkType::cloud:
        clouds_.insert_or_assign(chunk.info.number, chunk);
        break;
      case ChunkType::map_tile:
        tiles_.insert_or_assign(chunk.info.number, chunk);
        break;
      case ChunkType::object:
        objects_.insert_or_assign(static_cast<long>(chunk.info.number), chunk);
        break;
      case ChunkType::index:
        break;
    }
  }
}

template <class Record>
Record SceneFile::read(const IndexedChunk& chunk) const {
  const std::string bytes = file_.payload(chunk);
  Record record;
  ArchiveReader(bytes, source())(record);
  return record;
}

SceneScan SceneFile::scan(std::size_t i) const {
  return read<SceneScan>(scans_.at(i));
}

SceneCloud SceneFile::cloud(std::size_t i) const {
  const auto found = clouds_.find(scans_.at(i).info.number);
  return found == clouds_.end() ? SceneCloud() : decode_cloud(file_.payload(found->second), source());
}

std::vector<MapPoint> SceneFile::map() const {
  std::vector<MapPoint> points;
  for (const auto& [number, chunk] : tiles_) {
    const SceneCloud tile = decode_cloud(file_.payload(chunk), source());
    for_each_point(tile, [&](const ScenePoint& point, const PointGroup& group) {
      points.push_back({point.p, point.intensity, group.label});
    });
  }
  return points;
}

std::vector<long> SceneFile::objects() const {
  std::vector<long> ids;
  for (const auto& [id, chunk] : objects_) ids.push_back(id);
  return ids;
}

SceneCloud SceneFile::object(long id) const {
  const auto found = objects_.find(id);
  return found == objects_.end() ? SceneCloud() : decode_cloud(file_.payload(found->second), source());
}

std::uint64_t SceneFile::stored_bytes(ChunkType type) const {
  std::uint64_t sum = 0;
  for (const IndexedChunk& chunk : file_.chunks()) {
    if (chunk.info.type == type) sum += chunk.info.stored_bytes;
  }
  return sum;
}

PoseList robot_poses(const SceneFile& scene) {
  PoseList poses;
  for (std::size_t i = 0; i < scene.num_scans(); ++i) {
    const SceneScan scan = scene.scan(i);
    poses.frames.push_back(scan.frame);
    poses.stamps_s.push_back(scan.stamp_s);
    poses.T_world_body.push_back(scan.T_map_lidar);
  }
  return poses;
}

}  // namespace mlo
