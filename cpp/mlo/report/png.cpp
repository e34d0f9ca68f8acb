#include "mlo/report/png.hpp"

#include <algorithm>

#include "mlo/core/bytes.hpp"

namespace mlo {
namespace {

std::uint32_t adler32(std::string_view bytes) {
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const char c : bytes) {
    a = (a + static_cast<std::uint8_t>(c)) % 65521U;
    b = (b + a) % 65521U;
  }
  return b << 16U | a;
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes += static_cast<char>(value >> shift & 0xFFU);
  return bytes;
}

std::string chunk(std::string_view type, std::string_view data) {
  const std::string content = std::string(type) + std::string(data);
  return big_endian(static_cast<std::uint32_t>(data.size())) + content + big_endian(crc32(content));
}

// A zlib stream of stored blocks.
std::string stored(std::string_view data) {
  constexpr std::size_t kLargest = 65535;
  std::string stream("\x78\x01", 2);
  for (std::size_t offset = 0; offset < data.size(); offset += kLargest) {
    const std::size_t size = std::min(kLargest, data.size() - offset);
    stream += offset + size == data.size() ? '\x01' : '\x00';
    for (const std::size_t length : {size, ~size}) {
      stream += static_cast<char>(length & 0xFFU);
      stream += static_cast<char>(length >> 8U & 0xFFU);
    }
    stream += data.substr(offset, size);
  }
  return stream + big_endian(adler32(data));
}

}  // namespace

std::string png_of(std::span<const std::uint8_t> shades, std::size_t width, std::size_t height) {
  std::string rows;
  rows.reserve((width / 2 + 2) * height);
  for (std::size_t y = 0; y < height; ++y) {
    rows += '\0';  // no filter
    for (std::size_t x = 0; x < width; x += 2) {
      const unsigned left = shades[y * width + x] & 0xFU;
      const unsigned right = x + 1 < width ? shades[y * width + x + 1] & 0xFU : 0U;
      rows += static_cast<char>(left << 4U | right);
    }
  }
  // 4 bits of grey, nothing else of what PNG offers.
  const std::string header = big_endian(static_cast<std::uint32_t>(width)) +
                             big_endian(static_cast<std::uint32_t>(height)) + std::string("\x04\0\0\0\0", 5);
  return std::string("\x89PNG\r\n\x1a\n") + chunk("IHDR", header) + chunk("IDAT", stored(rows)) +
         chunk("IEND", "");
}

}  // namespace mlo
