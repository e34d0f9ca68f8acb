#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace mlo {

/// LZF, the compression inside binary_compressed PCD files (format: Marc Lehmann's liblzf).
/// Input that does not compress grows by at most 1/32 and one byte.
std::string lzf_compress(std::string_view bytes);

/// @param size  number of bytes that must come out
/// @return nothing when the data is damaged or does not give exactly this size
std::optional<std::string> lzf_decompress(std::string_view compressed, std::size_t size);

}  // namespace mlo
