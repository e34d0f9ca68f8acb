#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace mlo {

/// A grey image as a PNG file (16 shades, not compressed: small images need no library for it).
/// @param shades  width * height values row by row from the top, 0 black to 15 white
std::string png_of(std::span<const std::uint8_t> shades, std::size_t width, std::size_t height);

}  // namespace mlo
