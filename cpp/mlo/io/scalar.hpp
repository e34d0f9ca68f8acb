#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>

namespace mlo {

/// Numbers as files store them.
enum class ScalarType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

constexpr std::size_t size_of(ScalarType type) {
  switch (type) {
    case ScalarType::int8:
    case ScalarType::uint8:
      return 1;
    case ScalarType::int16:
    case ScalarType::uint16:
      return 2;
    case ScalarType::int32:
    case ScalarType::uint32:
    case ScalarType::float32:
      return 4;
    default:
      return 8;
  }
}

constexpr bool is_integer(ScalarType type) {
  return type != ScalarType::float32 && type != ScalarType::float64;
}

/// The number of type T at `bytes`, which needs no alignment.
template <class T>
T load(const char* bytes, std::endian order) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

/// The same with the type known at run time only. Integers beyond 2^53 lose their last digits.
inline double load_scalar(const char* bytes, ScalarType type, std::endian order) {
  switch (type) {
    case ScalarType::int8:
      return load<std::int8_t>(bytes, order);
    case ScalarType::uint8:
      return load<std::uint8_t>(bytes, order);
    case ScalarType::int16:
      return load<std::int16_t>(bytes, order);
    case ScalarType::uint16:
      return load<std::uint16_t>(bytes, order);
    case ScalarType::int32:
      return load<std::int32_t>(bytes, order);
    case ScalarType::uint32:
      return load<std::uint32_t>(bytes, order);
    case ScalarType::int64:
      return static_cast<double>(load<std::int64_t>(bytes, order));
    case ScalarType::uint64:
      return static_cast<double>(load<std::uint64_t>(bytes, order));
    case ScalarType::float32:
      return load<float>(bytes, order);
    case ScalarType::float64:
      return load<double>(bytes, order);
  }
  return 0.0;
}

/// Appends a number in little-endian order.
inline void append_uint32(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xFF);
}
inline void append_float32(std::string& bytes, float value) {
  append_uint32(bytes, std::bit_cast<std::uint32_t>(value));
}

}  // namespace mlo
