#include "mlo/report/png.hpp"

#include <algorithm>
#include <array>

namespace mlo {
namespace {

constexpr std::array<std::uint32_t, 256> kCrcTable = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1U) ^ ((value & 1U) != 0 ? 0xEDB88320U : 0U);
    table[i] = value;
  }
  return table;
}();

std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char c : bytes) crc = (crc >> 8U) ^ kCrcTable[(crc ^ static_cast<std::uint8_t>(c)) & 0xFFU];
  return ~crc;
}

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

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[group >> (18U - 6U * k) & 0x3FU];
    }
  }
  return text;
}

}  // namespace mlo
