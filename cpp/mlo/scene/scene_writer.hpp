#pragma once

#include <filesystem>
#include <map>
#include <span>

#include "mlo/scene/chunk_file.hpp"
#include "mlo/scene/config.hpp"
#include "mlo/scene/records.hpp"

namespace mlo {

/// How far a scene is written (core/archive.hpp).
struct SceneWriterState {
  std::vector<IndexedChunk> chunks = {};
  double last_stamp_s = 0.0;
  std::map<std::uint64_t, std::uint32_t> tile_checksums = {};  ///< of what was last written, by number

  static void archive(auto& self, auto& bytes) { bytes(self.chunks, self.last_stamp_s, self.tile_checksums); }
};

/// Writes a scene as it comes to be (docs/scene_format.md). What was written is in the file when a call
/// returns, so that a run that is killed leaves a scene up to its last scan.
class SceneWriter {
 public:
  /// Replaces a file of the same name.
  /// @throws InputError when it cannot be written; so do all calls below, and what is in the file stays
  SceneWriter(const std::filesystem::path& path, const SceneMeta& meta, const SceneConfig& config);
  /// Goes on with a scene where a writer was; what the file has beyond that is cut off.
  SceneWriter(const std::filesystem::path& path, SceneWriterState state, const SceneConfig& config);

  /// @param cloud  what the scan saw, in the lidar frame at its stamp; null or empty: nothing to keep
  void write(const SceneScan& scan, const SceneCloud* cloud);
  /// The static map as it is now; replaces the one before. Tiles that did not change are not written again.
  void write_map(std::span<const MapPoint> points);
  /// The shape of an object: its points in its own frame, all of one group; replaces the one before.
  void write_object(long id, const SceneCloud& cloud);
  /// Ends the file with its index.
  void finish();
  SceneWriterState state() const { return {file_.chunks(), last_stamp_s_, tile_checksums_}; }

 private:
  ChunkFileWriter file_;
  double last_stamp_s_ = 0.0;
  std::map<std::uint64_t, std::uint32_t> tile_checksums_;
};

}  // namespace mlo
