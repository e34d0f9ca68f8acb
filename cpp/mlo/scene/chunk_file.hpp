#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mlo/io/append_file.hpp"
#include "mlo/io/random_access_file.hpp"

// The container of a scene file: compressed chunks with checksums, and an index of them at the end
// (docs/scene_format.md).
namespace mlo {

enum class ChunkType : std::uint32_t { meta = 1, scan = 2, cloud = 3, map_tile = 4, index = 5, object = 6 };

/// What stands in front of a chunk's bytes.
struct ChunkInfo {
  ChunkType type = ChunkType::meta;
  std::uint64_t number = 0;  ///< of the frame, the tile or the object
  double first_stamp_s = 0.0;
  double last_stamp_s = 0.0;
  std::uint64_t raw_bytes = 0;     ///< without compression
  std::uint64_t stored_bytes = 0;  ///< in the file
  std::uint32_t checksum = 0;      ///< CRC-32 of the stored bytes

  static void archive(auto& self, auto& bytes) {
    bytes(self.type, self.number, self.first_stamp_s, self.last_stamp_s, self.raw_bytes, self.stored_bytes,
          self.checksum);
  }
};

struct IndexedChunk {
  ChunkInfo info;
  std::uint64_t offset = 0;  ///< of its header
  static void archive(auto& self, auto& bytes) { bytes(self.info, self.offset); }
};

/// Appends chunks; each is with the system when append() returns.
class ChunkFileWriter {
 public:
  /// Replaces a file of the same name. @throws InputError when it cannot be written
  ChunkFileWriter(const std::filesystem::path& path, int compression_level);
  /// Goes on after some chunks of a file; what it has beyond them is cut off.
  ChunkFileWriter(const std::filesystem::path& path, int compression_level, std::vector<IndexedChunk> chunks);

  /// @param info  type, number and stamps; the rest is filled in
  /// @throws InputError when it cannot be written; the chunks before are kept
  void append(ChunkInfo info, std::string_view payload);
  /// Writes the index; nothing can be appended after it.
  void finish();
  /// What was appended, for another writer to go on after it.
  const std::vector<IndexedChunk>& chunks() const { return chunks_; }

 private:
  AppendFile file_;
  int compression_level_;
  std::vector<IndexedChunk> chunks_;
};

/// Finds and reads chunks.
class ChunkFile {
 public:
  /// Without a usable index, the chunks are found one after the other, up to the first that is cut off or
  /// damaged.
  /// @throws InputError when the file cannot be read, is something else or of another version
  explicit ChunkFile(const std::filesystem::path& path);

  const std::vector<IndexedChunk>& chunks() const { return chunks_; }
  /// True: the file was ended with its index.
  bool complete() const { return complete_; }
  std::uint64_t size() const { return file_.size(); }
  const std::filesystem::path& path() const { return file_.path(); }
  /// @throws InputError when the bytes do not have the checksum
  std::string payload(const IndexedChunk& chunk) const;

 private:
  std::optional<IndexedChunk> chunk_at(std::uint64_t offset) const;
  bool read_index();
  void scan();
  std::string name_of(const IndexedChunk& chunk) const;

  RandomAccessFile file_;
  std::vector<IndexedChunk> chunks_;
  bool complete_ = false;
};

}  // namespace mlo
