#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mlo/report/png.hpp"

namespace mlo {
namespace {

std::string hex(const std::string& bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const char c : bytes) {
    text += kDigits[static_cast<unsigned char>(c) >> 4U];
    text += kDigits[static_cast<unsigned char>(c) & 0xFU];
  }
  return text;
}

// Three by two pixels, checked by hand against the specification; the end chunk is the same in every PNG
// file.
TEST(Png, KnownBytes) {
  const std::string png = png_of(std::vector<std::uint8_t>{0, 15, 1, 2, 3, 4}, 3, 2);
  const std::string bytes = hex(png);
  EXPECT_EQ(bytes.substr(0, 16), "89504e470d0a1a0a");
  // Length 13, IHDR, 3 x 2, 4 bits of grey.
  EXPECT_EQ(bytes.substr(16, 16 + 26),
            "0000000d49484452"
            "00000003"
            "00000002"
            "0400000000");
  // Two rows of filter byte and two bytes of pixels in one stored block of 6 bytes.
  EXPECT_NE(bytes.find("7801"
                       "01"
                       "0600"
                       "f9ff"
                       "000f10"
                       "002340"),
            std::string::npos);
  EXPECT_EQ(bytes.substr(bytes.size() - 24), "0000000049454e44ae426082");
}

TEST(Png, LargeImagesTakeSeveralBlocks) {
  const std::size_t side = 600;
  const std::string png = png_of(std::vector<std::uint8_t>(side * side, 7), side, side);
  EXPECT_EQ(png.size(), 8 + 25 + 12 + (2 + (301 * 600 + 65534) / 65535 * 5 + 301 * 600 + 4) + 12);
}

}  // namespace
}  // namespace mlo
