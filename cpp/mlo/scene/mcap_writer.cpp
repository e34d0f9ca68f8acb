#include "mlo/scene/mcap_writer.hpp"

#include <algorithm>
#include <limits>

#include "mlo/core/archive.hpp"
#include "mlo/core/bytes.hpp"
#include "mlo/scene/compression.hpp"

namespace mlo {
namespace {

constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
constexpr std::string_view kCompression = "zstd";
constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

enum class Op : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  summary_offset = 0x0E,
  data_end = 0x0F
};

template <class... Ts>
std::string numbers(const Ts&... values) {
  ArchiveWriter writer;
  writer(values...);
  return writer.take();
}

// Text, lists and maps of MCAP are preceded by their length in bytes.
std::string sized(std::string_view bytes) {
  return numbers(static_cast<std::uint32_t>(bytes.size())) + std::string(bytes);
}

std::string record(Op op, std::string_view content) {
  return numbers(op, std::uint64_t{content.size()}) + std::string(content);
}

template <class Key>
std::string map_bytes(const std::map<Key, std::uint64_t>& map) {
  std::string entries;
  for (const auto& [key, value] : map) entries += numbers(key, value);
  return sized(entries);
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path, int compression_level)
    : file_(path), compression_level_(compression_level) {
  put(kMcapMagic);
  put(record(Op::header, sized("") + sized("mlo")));
}

void McapWriter::put(std::string_view bytes) {
  file_.write(bytes);
  checksum_ = crc32(bytes, checksum_);
  size_ += bytes.size();
}

McapWriter::Channel McapWriter::add_channel(std::string_view topic, std::string_view schema_name,
                                            std::string_view schema) {
  const auto id = static_cast<Channel>(counts_.size() + 1);  // of the schema too: each channel has its own
  const std::string schema_record =
      record(Op::schema, numbers(id) + sized(schema_name) + sized("jsonschema") + sized(schema));
  const std::string channel_record =
      record(Op::channel, numbers(id, id) + sized(topic) + sized("json") + sized(""));
  schemas_ += schema_record;
  channels_ += channel_record;
  chunk_ += schema_record + channel_record;
  counts_[id] = 0;
  return id;
}

void McapWriter::write(Channel channel, std::uint64_t stamp_ns, std::string_view message) {
  const bool first =
      std::all_of(counts_.begin(), counts_.end(), [](const auto& count) { return count.second == 0; });
  first_stamp_ns_ = first ? stamp_ns : std::min(first_stamp_ns_, stamp_ns);
  last_stamp_ns_ = std::max(last_stamp_ns_, stamp_ns);
  const auto sequence = static_cast<std::uint32_t>(counts_.at(channel)++);
  chunk_messages_[channel].emplace_back(stamp_ns, chunk_.size());
  chunk_ += record(Op::message, numbers(channel, sequence, stamp_ns, stamp_ns) + std::string(message));
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

std::string McapWriter::write_message_indexes() {
  std::map<Channel, std::uint64_t> offsets;
  for (auto& [channel, entries] : chunk_messages_) {
    std::stable_sort(entries.begin(), entries.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    offsets[channel] = size_;
    std::string bytes;
    for (const auto& [stamp_ns, offset] : entries) bytes += numbers(stamp_ns, offset);
    put(record(Op::message_index, numbers(channel) + sized(bytes)));
  }
  return map_bytes(offsets);
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  std::uint64_t first_ns = chunk_messages_.empty() ? 0 : std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ns = 0;
  for (const auto& [channel, entries] : chunk_messages_) {
    for (const auto& [stamp_ns, offset] : entries) {
      first_ns = std::min(first_ns, stamp_ns);
      last_ns = std::max(last_ns, stamp_ns);
    }
  }
  const std::string compressed = compress(chunk_, compression_level_);
  const std::uint64_t start = size_;
  put(record(Op::chunk, numbers(first_ns, last_ns, std::uint64_t{chunk_.size()}, crc32(chunk_)) +
                            sized(kCompression) + numbers(std::uint64_t{compressed.size()}) + compressed));
  const std::uint64_t end = size_;
  const std::string offsets = write_message_indexes();
  chunk_indexes_ +=
      record(Op::chunk_index, numbers(first_ns, last_ns, start, end - start) + offsets +
                                  numbers(size_ - end) + sized(kCompression) +
                                  numbers(std::uint64_t{compressed.size()}, std::uint64_t{chunk_.size()}));
  ++num_chunks_;
  chunk_.clear();
  chunk_messages_.clear();
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0;
  for (const auto& [channel, count] : counts_) messages += count;
  const auto channels = static_cast<std::uint16_t>(counts_.size());
  constexpr std::uint32_t kNone = 0;  // attachments, metadata
  return record(Op::statistics, numbers(messages, channels, std::uint32_t{channels}, kNone, kNone,
                                        num_chunks_, first_stamp_ns_, last_stamp_ns_) +
                                    map_bytes(counts_));
}

void McapWriter::finish() {
  end_chunk();
  put(record(Op::data_end, numbers(checksum_)));

  const std::uint64_t summary_start = size_;
  checksum_ = 0;  // the summary has its own
  std::string offsets;
  const auto put_group = [&](Op op, const std::string& records) {
    if (records.empty()) return;
    offsets += record(Op::summary_offset, numbers(op, size_, std::uint64_t{records.size()}));
    put(records);
  };
  put_group(Op::schema, schemas_);
  put_group(Op::channel, channels_);
  put_group(Op::chunk_index, chunk_indexes_);
  put_group(Op::statistics, statistics());
  const std::uint64_t offsets_start = size_;
  put(offsets);
  constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
  put(numbers(Op::footer, kFooterBytes, summary_start, offsets_start));
  put(numbers(checksum_));
  put(kMcapMagic);
  file_.commit();
}

}  // namespace mlo
