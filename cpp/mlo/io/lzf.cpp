#include "mlo/io/lzf.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

// The stream is a sequence of
//   000LLLLL                         literals: the L + 1 bytes that follow
//   LLLooooo oooooooo                match: L + 2 bytes (L in 1..6) from o + 1 bytes back
//   111ooooo LLLLLLLL oooooooo       match: L + 9 bytes from o + 1 bytes back
namespace mlo {
namespace {

constexpr std::size_t kMaxLiterals = 32;
constexpr std::size_t kMaxOffset = 1 << 13;
constexpr std::size_t kMinMatch = 3;
constexpr std::size_t kMaxMatch = 264;
constexpr std::size_t kLongLength = 7;  // value of LLL that announces a length byte
constexpr int kHashBits = 14;
constexpr std::uint32_t kNotSeen = 0xFFFFFFFF;

std::uint32_t hash3(const char* p) {
  const auto byte = [p](int i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(p[i])); };
  return ((byte(0) << 16 | byte(1) << 8 | byte(2)) * 2654435761U) >> (32 - kHashBits);
}

void put_literals(std::string& out, std::string_view literals) {
  while (!literals.empty()) {
    const std::string_view run = literals.substr(0, kMaxLiterals);
    out += static_cast<char>(run.size() - 1);
    out += run;
    literals.remove_prefix(run.size());
  }
}

void put_match(std::string& out, std::size_t length, std::size_t distance) {
  const std::size_t offset = distance - 1;
  const std::size_t code = length - 2;
  out += static_cast<char>(std::min(code, kLongLength) << 5 | offset >> 8);
  if (code >= kLongLength) out += static_cast<char>(code - kLongLength);
  out += static_cast<char>(offset & 0xFF);
}

std::size_t match_length(std::string_view bytes, std::size_t earlier, std::size_t i) {
  const std::size_t limit = std::min(kMaxMatch, bytes.size() - i);
  std::size_t length = 0;
  while (length < limit && bytes[earlier + length] == bytes[i + length]) ++length;
  return length;
}

}  // namespace

std::string lzf_compress(std::string_view bytes) {
  std::vector<std::uint32_t> latest(std::size_t{1} << kHashBits,
                                    kNotSeen);  // position of the latest such triple
  std::string out;
  std::size_t literals_begin = 0;
  std::size_t i = 0;
  while (i + kMinMatch <= bytes.size()) {
    std::uint32_t& entry = latest[hash3(&bytes[i])];
    const std::size_t earlier = entry;
    entry = static_cast<std::uint32_t>(i);
    const bool near = earlier != kNotSeen && i - earlier <= kMaxOffset;
    const std::size_t length = near ? match_length(bytes, earlier, i) : 0;
    if (length < kMinMatch) {
      ++i;
      continue;
    }
    put_literals(out, bytes.substr(literals_begin, i - literals_begin));
    put_match(out, length, i - earlier);
    literals_begin = i += length;
  }
  put_literals(out, bytes.substr(literals_begin));
  return out;
}

std::optional<std::string> lzf_decompress(std::string_view compressed, std::size_t size) {
  std::string out;
  out.reserve(size);
  const auto byte = [&](std::size_t i) -> std::size_t { return static_cast<unsigned char>(compressed[i]); };
  for (std::size_t i = 0; i < compressed.size();) {
    const std::size_t control = byte(i++);
    if (control < kMaxLiterals) {
      const std::size_t count = control + 1;
      if (count > compressed.size() - i || count > size - out.size()) return std::nullopt;
      out += compressed.substr(i, count);
      i += count;
      continue;
    }
    std::size_t length = control >> 5;
    const bool has_length_byte = length == kLongLength;
    if (compressed.size() - i < (has_length_byte ? 2U : 1U)) return std::nullopt;
    if (has_length_byte) length += byte(i++);
    length += 2;
    const std::size_t distance = ((control & 0x1F) << 8 | byte(i++)) + 1;
    if (distance > out.size() || length > size - out.size()) return std::nullopt;
    for (; length > 0; --length) out += out[out.size() - distance];  // may overlap what it writes
  }
  return out.size() == size ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace mlo
