#include "mlo/scene/chunk_file.hpp"

#include <fmt/format.h>

#include "mlo/core/archive.hpp"
#include "mlo/core/bytes.hpp"
#include "mlo/scene/compression.hpp"

namespace mlo {
namespace {

constexpr std::string_view kSceneMagic = "MLOSCENE";
constexpr std::string_view kIndexMagic = "MLOINDEX";
constexpr std::uint32_t kVersion = 1;
constexpr std::string_view kChunkMarker = "MLOC";
constexpr std::size_t kFileHeaderBytes = 12;
constexpr std::size_t kInfoBytes = 48;
constexpr std::size_t kChunkHeaderBytes = 4 + kInfoBytes + 4;
constexpr std::size_t kTrailerBytes = 16;

template <class... Ts>
std::string archived(const Ts&... values) {
  ArchiveWriter writer;
  writer(values...);
  return writer.take();
}

std::string chunk_header(const ChunkInfo& info) {
  const std::string bytes = archived(info);
  return std::string(kChunkMarker) + bytes + archived(crc32(bytes));
}

std::uint64_t end_of(const IndexedChunk& chunk) {
  return chunk.offset + kChunkHeaderBytes + chunk.info.stored_bytes;
}

}  // namespace

ChunkFileWriter::ChunkFileWriter(const std::filesystem::path& path, int compression_level)
    : file_(path), compression_level_(compression_level) {
  file_.append(std::string(kSceneMagic) + archived(kVersion));
}

ChunkFileWriter::ChunkFileWriter(const std::filesystem::path& path, int compression_level,
                                 std::vector<IndexedChunk> chunks)
    : file_(path, chunks.empty() ? kFileHeaderBytes : end_of(chunks.back())),
      compression_level_(compression_level),
      chunks_(std::move(chunks)) {}

void ChunkFileWriter::append(ChunkInfo info, std::string_view payload) {
  const std::string stored = compress(payload, compression_level_);
  info.raw_bytes = payload.size();
  info.stored_bytes = stored.size();
  info.checksum = crc32(stored);
  const std::uint64_t offset = file_.size();
  file_.append(chunk_header(info) + stored);
  chunks_.push_back({info, offset});
}

void ChunkFileWriter::finish() {
  const std::uint64_t offset = file_.size();
  append({.type = ChunkType::index}, archived(chunks_));
  file_.append(archived(offset) + std::string(kIndexMagic));
}

ChunkFile::ChunkFile(const std::filesystem::path& path) : file_(path) {
  const std::string header = file_.read(0, kFileHeaderBytes);
  if (header.size() < kFileHeaderBytes || !header.starts_with(kSceneMagic)) {
    throw InputError(
        fmt::format("{}: is no scene file; give the scene.mlo that 'mlo run' wrote", path.string()));
  }
  if (!header.ends_with(archived(kVersion))) {
    throw InputError(
        fmt::format("{}: is of another version of the scene format than {}; read it with the program "
                    "that wrote it, or run again",
                    path.string(), kVersion));
  }
  complete_ = read_index();
  if (!complete_) scan();
}

std::optional<IndexedChunk> ChunkFile::chunk_at(std::uint64_t offset) const {
  const std::string header = file_.read(offset, kChunkHeaderBytes);
  if (header.size() < kChunkHeaderBytes || !header.starts_with(kChunkMarker)) return std::nullopt;
  const std::string_view info_bytes = std::string_view(header).substr(kChunkMarker.size(), kInfoBytes);
  if (!header.ends_with(archived(crc32(info_bytes)))) return std::nullopt;
  IndexedChunk chunk{.info = {}, .offset = offset};
  ArchiveReader(info_bytes, file_.path().string())(chunk.info);
  if (chunk.info.stored_bytes > file_.size() || end_of(chunk) > file_.size()) return std::nullopt;
  return chunk;
}

bool ChunkFile::read_index() {
  if (file_.size() < kFileHeaderBytes + kTrailerBytes) return false;
  const std::string trailer = file_.read(file_.size() - kTrailerBytes, kTrailerBytes);
  if (!trailer.ends_with(kIndexMagic)) return false;
  std::uint64_t offset = 0;
  ArchiveReader(trailer, file_.path().string())(offset);
  const std::optional<IndexedChunk> index = chunk_at(offset);
  if (!index || index->info.type != ChunkType::index) return false;
  try {
    const std::string bytes = payload(*index);
    ArchiveReader(bytes, name_of(*index))(chunks_);
  } catch (const InputError&) {  // the chunks themselves may still be good
    chunks_.clear();
    return false;
  }
  return true;
}

void ChunkFile::scan() {
  std::uint64_t offset = kFileHeaderBytes;
  while (const std::optional<IndexedChunk> chunk = chunk_at(offset)) {
    const std::string stored = file_.read(offset + kChunkHeaderBytes, chunk->info.stored_bytes);
    if (crc32(stored) != chunk->info.checksum || chunk->info.type == ChunkType::index) return;
    chunks_.push_back(*chunk);
    offset = end_of(*chunk);
  }
}

std::string ChunkFile::name_of(const IndexedChunk& chunk) const {
  return fmt::format("{}, chunk at byte {}", file_.path().string(), chunk.offset);
}

std::string ChunkFile::payload(const IndexedChunk& chunk) const {
  const std::string stored = file_.read(chunk.offset + kChunkHeaderBytes, chunk.info.stored_bytes);
  if (stored.size() != chunk.info.stored_bytes || crc32(stored) != chunk.info.checksum) {
    throw InputError(name_of(chunk) +
                     ": the data is damaged: its checksum is wrong; restore the file from a copy");
  }
  return decompress(stored, chunk.info.raw_bytes, name_of(chunk));
}

}  // namespace mlo
