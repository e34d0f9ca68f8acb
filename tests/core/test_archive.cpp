#include <cmath>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "mlo/core/archive.hpp"
#include "mlo/core/se3.hpp"

namespace mlo {
namespace {

enum class Colour : std::uint8_t { red = 1, green = 2 };

struct Inner {
  Colour colour = Colour::red;
  std::optional<double> value;
  bool operator==(const Inner&) const = default;
  static void archive(auto& self, auto& bytes) { bytes(self.colour, self.value); }
};

struct Outer {
  long id = 0;
  bool flag = false;
  std::string name;
  std::vector<Inner> inners;
  std::vector<float> numbers;
  std::deque<std::vector<int>> queue;
  std::map<int, std::string> names;
  std::array<std::uint16_t, 3> triple{};
  int pair[2] = {0, 0};
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
  bool operator==(const Outer&) const = default;
  static void archive(auto& self, auto& bytes) {
    bytes(self.id, self.flag, self.name, self.inners, self.numbers, self.queue, self.names, self.triple,
          self.pair, self.matrix);
  }
};

template <class T>
std::string bytes_of(const T& value) {
  ArchiveWriter writer;
  writer(value);
  return writer.take();
}

Outer example() {
  return {.id = -7,
          .flag = true,
          .name = "\xc3\xa4 b",
          .inners = {{Colour::green, 0.1}, {}},
          .numbers = {1.5F, -0.0F},
          .queue = {{1, 2}, {}},
          .names = {{3, "c"}, {1, "a"}},
          .triple = {1, 2, 0xFFFF},
          .pair = {4, 5},
          .matrix = Eigen::Matrix2d::Random()};
}

TEST(Archive, EverythingComesBack) {
  const Outer before = example();
  const std::string bytes = bytes_of(before);
  Outer after;
  ArchiveReader reader(bytes, "test");
  reader(after);
  EXPECT_TRUE(before == after);
  EXPECT_TRUE(reader.at_end());
}

TEST(Archive, NumbersAreLittleEndian) {
  EXPECT_EQ(bytes_of(std::uint32_t{0x01020304}), std::string("\x04\x03\x02\x01", 4));
  EXPECT_EQ(bytes_of(std::string("x")), std::string("\x01\0\0\0\0\0\0\0x", 9));
}

// Normalising a rotation a second time may change its last bit.
TEST(Archive, PosesKeepEveryBit) {
  for (int i = 0; i < 200; ++i) {
    const SE3 pose = SE3::exp(SE3::Tangent::Random());
    const std::string bytes = bytes_of(pose);
    SE3 back;
    ArchiveReader reader(bytes, "test");
    reader(back);
    EXPECT_TRUE(back.rotation().coeffs() == pose.rotation().coeffs());
    EXPECT_TRUE(back.translation() == pose.translation());
  }
}

TEST(Archive, NotANumberComesBack) {
  const std::string bytes = bytes_of(std::numeric_limits<double>::quiet_NaN());
  double value = 0.0;
  ArchiveReader reader(bytes, "test");
  reader(value);
  EXPECT_TRUE(std::isnan(value));
}

TEST(Archive, BytesThatEndTooEarlyAreAnInputError) {
  const std::string bytes = bytes_of(example());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Outer after;
    ArchiveReader reader(std::string_view(bytes).substr(0, size), "test");
    EXPECT_THROW(reader(after), InputError) << size;
  }
}

TEST(Archive, ALengthThatCannotBeIsAnInputError) {
  const std::string bytes = bytes_of(std::numeric_limits<std::uint64_t>::max());
  std::vector<double> numbers;
  std::string text;
  ArchiveReader first(bytes, "test");
  EXPECT_THROW(first(numbers), InputError);
  ArchiveReader second(bytes, "test");
  EXPECT_THROW(second(text), InputError);
}

}  // namespace
}  // namespace mlo
