#include "mlo/scene/compression.hpp"

#include <new>

#include <zstd.h>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

// Zstandard needs 3 bytes for a block of 128 KiB at the least: a larger promise is a damaged length.
constexpr std::size_t kMostFromOneByte = 64 * 1024;

}  // namespace

std::string compress(std::string_view bytes, int level) {
  std::string compressed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(compressed.data(), compressed.size(), bytes.data(), bytes.size(), level);
  if (ZSTD_isError(size) != 0U) throw std::bad_alloc();  // the only way to fail with room for the worst case
  compressed.resize(size);
  return compressed;
}

std::string decompress(std::string_view compressed, std::size_t size, const std::string& source) {
  const auto fail = [&] { throw InputError(source + ": the data is damaged: it does not decompress"); };
  if (size / kMostFromOneByte > compressed.size()) fail();
  std::string bytes(size, '\0');
  const std::size_t result =
      ZSTD_decompress(bytes.data(), bytes.size(), compressed.data(), compressed.size());
  if (ZSTD_isError(result) != 0U || result != size) fail();
  return bytes;
}

}  // namespace mlo
