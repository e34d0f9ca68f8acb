#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace mlo {

/// The CRC-32 of PNG, zip and MCAP (ISO 3309, polynomial 0xEDB88320 reversed).
/// @param before  that of the bytes in front, to go on with
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

/// Base 64 with padding (RFC 4648).
std::string base64(std::string_view bytes);

}  // namespace mlo
