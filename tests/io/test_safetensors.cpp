#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/io/safetensors.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

using ::testing::HasSubstr;

TensorFile small_file() {
  TensorFile file;
  file.metadata = {{"format", "test"}, {"note", "\"quoted\" \xC3\xA4"}};
  file.tensors["b.weight"] = {{2, 3}, {1.0F, -2.5F, 0.0F, 1e-30F, 3e38F, -0.0F}};
  file.tensors["a"] = {{}, {7.0F}};
  file.tensors["empty"] = {{0, 4}, {}};
  return file;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string with_header(std::string_view header, std::string_view data) {
  std::string bytes;
  for (std::size_t shift = 0; shift < 64; shift += 8)
    bytes += static_cast<char>(header.size() >> shift & 0xFFU);
  return bytes.append(header).append(data);
}

/// What the reader says of a file with this content; empty if it takes it.
std::string complaint_about(std::string_view content) {
  const test::TempFolder folder;
  const auto path = folder.write("broken.safetensors", content);
  try {
    read_safetensors(path);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(path.string()));
    return error.what();
  }
  return "";
}

TEST(Safetensors, GivesBackWhatWasWrittenInTheSameBytes) {
  const test::TempFolder folder;
  const auto path = folder.path() / "weights.safetensors";
  write_safetensors(path, small_file());
  EXPECT_EQ(read_safetensors(path), small_file());
  const std::string once = bytes_of(path);
  write_safetensors(path, read_safetensors(path));
  EXPECT_EQ(bytes_of(path), once);
  EXPECT_EQ(once.size() % 4, 0U);
}

TEST(Safetensors, WithoutTensors) {
  const test::TempFolder folder;
  const auto path = folder.path() / "none.safetensors";
  write_safetensors(path, {});
  EXPECT_EQ(read_safetensors(path), TensorFile{});
}

TEST(Safetensors, KnownBytes) {
  const test::TempFolder folder;
  const auto path = folder.path() / "known.safetensors";
  write_safetensors(path, {{}, {{"x", {{1}, {1.0F}}}}});
  // padded to a multiple of eight
  std::string header = R"({"x":{"data_offsets":[0,4],"dtype":"F32","shape":[1]}})";
  header.resize((header.size() + 7) / 8 * 8, ' ');
  EXPECT_EQ(bytes_of(path), with_header(header, std::string_view("\0\0\x80\x3f", 4)));
}

TEST(Safetensors, NarrowAndWideTypesBecomeFloat) {
  const test::TempFolder folder;
  const std::string header =
      R"({"d":{"dtype":"F64","shape":[1],"data_offsets":[0,8]},"i":{"dtype":"I64","shape":[1],"data_offsets":[8,16]},)"
      R"("h":{"dtype":"F16","shape":[5],"data_offsets":[16,26]},"b":{"dtype":"BF16","shape":[1],"data_offsets":[26,28]}})";
  std::string data(28, '\0');
  const double d = -0.1;
  const std::int64_t i = -12;
  std::memcpy(data.data(), &d, 8);
  std::memcpy(data.data() + 8, &i, 8);
  // 1, -2, the smallest number, the largest one, infinity
  const std::uint16_t half[] = {0x3C00, 0xC000, 0x0001, 0x7BFF, 0x7C00};
  std::memcpy(data.data() + 16, half, 10);
  const std::uint16_t brain = 0xC040;  // -3
  std::memcpy(data.data() + 26, &brain, 2);
  const TensorFile file = read_safetensors(folder.write("types.safetensors", with_header(header, data)));
  EXPECT_EQ(file.tensors.at("d").values.at(0), -0.1F);
  EXPECT_EQ(file.tensors.at("i").values.at(0), -12.0F);
  EXPECT_EQ(file.tensors.at("h").values, (std::vector<float>{1.0F, -2.0F, std::ldexp(1.0F, -24), 65504.0F,
                                                             std::numeric_limits<float>::infinity()}));
  EXPECT_EQ(file.tensors.at("b").values.at(0), -3.0F);
}

TEST(Safetensors, EveryTruncationIsRefused) {
  const test::TempFolder folder;
  const auto path = folder.path() / "whole.safetensors";
  write_safetensors(path, small_file());
  const std::string whole = bytes_of(path);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(complaint_about(std::string_view(whole).substr(0, size)), "") << size;
  }
  EXPECT_THAT(complaint_about(whole + "x"), HasSubstr("too many"));
}

TEST(Safetensors, BrokenHeadersAreRefused) {
  const std::string four(4, '\0');
  const std::string eight(8, '\0');
  const auto header = [](std::string_view shape, std::string_view offsets,
                         std::string_view type = "\"F32\"") {
    return std::string(R"({"x":{"dtype":)") + std::string(type) + R"(,"shape":)" + std::string(shape) +
           R"(,"data_offsets":)" + std::string(offsets) + "}}";
  };
  EXPECT_EQ(complaint_about(with_header(header("[1]", "[0,4]"), four)), "");
  EXPECT_THAT(complaint_about(std::string(8, '\xFF')), HasSubstr("header has"));
  EXPECT_THAT(complaint_about(with_header("{", "")), HasSubstr("not JSON"));
  EXPECT_THAT(complaint_about(with_header("\xFF{}", "")), HasSubstr("not JSON"));
  EXPECT_THAT(complaint_about(with_header("[1]", "")), HasSubstr("no JSON object"));
  EXPECT_THAT(complaint_about(with_header(R"({"x":3})", "")), HasSubstr("no JSON object"));
  EXPECT_THAT(complaint_about(with_header(R"({"__metadata__":{"a":1}})", "")), HasSubstr("no text"));
  EXPECT_THAT(complaint_about(with_header(R"({"__metadata__":[]})", "")), HasSubstr("no JSON object"));
  EXPECT_THAT(complaint_about(with_header(header("[-1]", "[0,4]"), four)), HasSubstr("no shape"));
  EXPECT_THAT(complaint_about(with_header(header("[1.5]", "[0,4]"), four)), HasSubstr("no shape"));
  EXPECT_THAT(complaint_about(with_header(header("[NaN]", "[0,4]"), four)), HasSubstr("not JSON"));
  EXPECT_NE(complaint_about(with_header(header("[1e999]", "[0,4]"), four)), "");
  EXPECT_THAT(complaint_about(with_header(header("null", "[0,4]"), four)), HasSubstr("no shape"));
  EXPECT_THAT(complaint_about(with_header(header("[2]", "[0,4]"), four)), HasSubstr("its shape needs"));
  EXPECT_THAT(complaint_about(with_header(header("[4294967296,4294967296]", "[0,4]"), four)),
              HasSubstr("its shape needs"));
  EXPECT_THAT(complaint_about(with_header(header("[1]", "[0,4,8]"), four)), HasSubstr("no two data_offsets"));
  EXPECT_THAT(complaint_about(with_header(header("[1]", "[4,0]"), four)), HasSubstr("lies at bytes"));
  EXPECT_THAT(complaint_about(with_header(header("[1]", "[4,8]"), four)), HasSubstr("lies at bytes"));
  EXPECT_THAT(complaint_about(with_header(header("[1]", "[4,8]"), eight)), HasSubstr("belong to no tensor"));
  EXPECT_THAT(complaint_about(with_header(header("[1]", "[0,4]"), eight)), HasSubstr("too many"));
  EXPECT_THAT(complaint_about(with_header(header("[1]", "[0,4]", "\"Q4\""), four)), HasSubstr("type 'Q4'"));
  EXPECT_THAT(complaint_about(with_header(header("[1]", "[0,4]", "7"), four)), HasSubstr("type ''"));
}

TEST(Safetensors, RepeatedNamesAndOverlapsAreRefused) {
  const std::string eight(8, '\0');
  const std::string x = R"("x":{"dtype":"F32","shape":[1],"data_offsets":[0,4]})";
  const std::string x_after = R"("x":{"dtype":"F32","shape":[1],"data_offsets":[4,8]})";
  const std::string y = R"("y":{"dtype":"F32","shape":[2],"data_offsets":[0,8]})";
  EXPECT_THAT(complaint_about(with_header("{" + x + "," + x_after + "}", eight)),
              HasSubstr("'x' stands twice"));
  EXPECT_THAT(complaint_about(with_header("{" + x + "," + y + "}", eight)), HasSubstr("overlaps"));
  EXPECT_THAT(complaint_about(with_header(R"({"__metadata__":{"a":"1","a":"2"}})", "")),
              HasSubstr("'a' stands twice"));
}

TEST(Safetensors, MissingFilesAndTensorsThatContradictThemselves) {
  const test::TempFolder folder;
  EXPECT_THROW(read_safetensors(folder.path() / "none"), InputError);
  EXPECT_THROW(write_safetensors(folder.path() / "no" / "folder", small_file()), InputError);
  const auto path = folder.path() / "wrong";
  EXPECT_THROW(write_safetensors(path, {{}, {{"x", {{3}, {1.0F}}}}}), InputError);
  EXPECT_THROW(write_safetensors(path, {{}, {{"x", {{-1}, {1.0F}}}}}), InputError);
  EXPECT_THROW(write_safetensors(path, {{}, {{"x", {{1LL << 40, 1LL << 40}, {1.0F}}}}}), InputError);
  EXPECT_THROW(write_safetensors(path, {{}, {{"__metadata__", {{1}, {1.0F}}}}}), InputError);
  EXPECT_THROW(write_safetensors(path, {{}, {{"\xFF", {{1}, {1.0F}}}}}), InputError);
  EXPECT_THROW(write_safetensors(path, {{{"a", "\xFF"}}, {}}), InputError);
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace mlo
