#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "mlo/io/dataset.hpp"
#include "mlo/scene/chunk_file.hpp"
#include "mlo/scene/records.hpp"

namespace mlo {

/// A scene on disk (docs/scene_format.md). Opening reads the index only; scans, clouds and tiles are read
/// when they are asked for.
class SceneFile {
 public:
  /// A file that was cut off opens with what it has up to there.
  /// @throws InputError when it cannot be read or is no scene
  explicit SceneFile(const std::filesystem::path& path);

  /// False: the run was killed, or still goes on.
  bool complete() const { return file_.complete(); }
  const SceneMeta& meta() const { return meta_; }
  std::size_t num_scans() const { return scans_.size(); }
  double stamp_s(std::size_t i) const { return scans_.at(i).info.first_stamp_s; }
  /// @throws InputError, as all below, when the data is damaged
  SceneScan scan(std::size_t i) const;
  /// In the lidar frame at the scan's stamp; empty where the file has none.
  SceneCloud cloud(std::size_t i) const;
  /// The static map when it was last saved.
  std::vector<MapPoint> map() const;

  /// The shape of an object, in its own frame; empty where the file has none: the object may still have been
  /// in sight when the run was killed.
  SceneCloud object(long id) const;
  /// Ids of the objects whose shapes it has.
  std::vector<long> objects() const;

  /// Bytes of all chunks of a type, as stored.
  std::uint64_t stored_bytes(ChunkType type) const;
  std::uint64_t size() const { return file_.size(); }
  const std::filesystem::path& path() const { return file_.path(); }

 private:
  template <class Record>
  Record read(const IndexedChunk& chunk) const;
  std::string source() const { return file_.path().string(); }

  ChunkFile file_;
  SceneMeta meta_;
  std::vector<IndexedChunk> scans_;
  std::map<std::uint64_t, IndexedChunk> clouds_;  // by frame
  std::map<std::uint64_t, IndexedChunk> tiles_;   // the last of each number
  std::map<long, IndexedChunk> objects_;          // by id
};

/// Poses of the robot at the stamps of all scans, with their frames.
PoseList robot_poses(const SceneFile& scene);

}  // namespace mlo
