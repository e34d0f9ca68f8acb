#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mlo {

/// Zstandard (RFC 8878). @param level  1 (fast) to 19 (small)
std::string compress(std::string_view bytes, int level);

/// @param size    how many bytes must come out
/// @param source  where the bytes come from, for messages
/// @throws InputError when the bytes are damaged
std::string decompress(std::string_view compressed, std::size_t size, const std::string& source);

}  // namespace mlo
