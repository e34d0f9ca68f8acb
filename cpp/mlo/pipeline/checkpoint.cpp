#include "mlo/pipeline/checkpoint.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "mlo/core/archive.hpp"
#include "mlo/core/bytes.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/text.hpp"
#include "mlo/scene/compression.hpp"

namespace mlo {
namespace {

constexpr std::string_view kMagic = "MLOSTATE";
constexpr int kCompressionLevel = 1;

struct Content {
  std::string owner;
  std::uint64_t size = 0;  // of the state
  std::string compressed;

  static void archive(auto& self, auto& bytes) { bytes(self.owner, self.size, self.compressed); }
};

// The first lines in which two texts differ.
std::pair<std::string, std::string> difference(std::string_view a, std::string_view b) {
  const std::vector<std::string_view> lines_a = split_lines(a);
  const std::vector<std::string_view> lines_b = split_lines(b);
  for (std::size_t i = 0; i < std::max(lines_a.size(), lines_b.size()); ++i) {
    const std::string_view line_a = i < lines_a.size() ? lines_a[i] : "";
    const std::string_view line_b = i < lines_b.size() ? lines_b[i] : "";
    if (line_a != line_b) return {std::string(line_a), std::string(line_b)};
  }
  return {};
}

}  // namespace

void write_checkpoint(const std::filesystem::path& file, const std::string& owner, const std::string& state) {
  ArchiveWriter content;
  content(Content{owner, state.size(), compress(state, kCompressionLevel)});
  ArchiveWriter checksum;
  checksum(crc32(content.bytes()));
  AtomicFile whole(file);
  whole.write(kMagic);
  whole.write(checksum.bytes());
  whole.write(content.bytes());
  whole.commit();
}

std::optional<std::string> read_checkpoint(const std::filesystem::path& file, const std::string& owner) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  const std::string bytes = read_file(file);
  const auto fail = [&](const std::string& problem) {
    throw InputError(fmt::format("{}: {}; run again without --resume", file.string(), problem));
  };
  if (!bytes.starts_with(kMagic)) fail("is no state of a run");
  std::string_view stored = std::string_view(bytes).substr(kMagic.size());
  std::uint32_t checksum = 0;
  ArchiveReader(stored, file.string())(checksum);
  stored.remove_prefix(sizeof(checksum));
  if (crc32(stored) != checksum) fail("is damaged: its checksum is wrong");
  Content content;
  ArchiveReader(stored, file.string())(content);
  if (content.owner != owner) {
    const auto [then, now] = difference(content.owner, owner);
    fail(fmt::format("belongs to another run: it has '{}', this one '{}'", then, now));
  }
  return decompress(content.compressed, content.size, file.string());
}

}  // namespace mlo
