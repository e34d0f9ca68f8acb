#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mlo/io/atomic_file.hpp"

namespace mlo {

/// Writes MCAP files (https://mcap.dev/spec) of JSON messages: compressed chunks, their indexes, and a
/// summary. The file appears whole or not at all.
class McapWriter {
 public:
  using Channel = std::uint16_t;

  /// @throws InputError when the file cannot be written; so do all calls below
  McapWriter(const std::filesystem::path& path, int compression_level);

  /// @param schema  JSON Schema of the messages
  Channel add_channel(std::string_view topic, std::string_view schema_name, std::string_view schema);
  void write(Channel channel, std::uint64_t stamp_ns, std::string_view message);
  void finish();

 private:
  /// Where a message of the chunk is: its stamp and its offset.
  using IndexEntry = std::pair<std::uint64_t, std::uint64_t>;

  void put(std::string_view bytes);
  void end_chunk();
  std::string write_message_indexes();
  std::string statistics() const;

  AtomicFile file_;
  int compression_level_;
  std::uint64_t size_ = 0;
  std::uint32_t checksum_ = 0;  // of all that was put
  std::string schemas_;         // all records of a kind, for the summary
  std::string channels_;
  std::string chunk_indexes_;
  std::string chunk_;  // the records of the chunk that is being filled
  std::map<Channel, std::vector<IndexEntry>> chunk_messages_;
  std::map<Channel, std::uint64_t> counts_;
  std::uint32_t num_chunks_ = 0;
  std::uint64_t first_stamp_ns_ = 0;
  std::uint64_t last_stamp_ns_ = 0;
};

}  // namespace mlo
