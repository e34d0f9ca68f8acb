#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/file_bytes.hpp"
#include "mlo/core/bytes.hpp"
#include "mlo/io/scalar.hpp"
#include "mlo/scene/mcap_writer.hpp"
#include "mlo/scene/scene_export.hpp"
#include "scene/small_scene.hpp"
#include "temp_folder.hpp"

namespace mlo {
namespace {

constexpr std::size_t kMagicBytes = 8;
constexpr std::size_t kRecordHeaderBytes = 9;
constexpr std::size_t kFooterBytes = kRecordHeaderBytes + 20;

template <class T>
T number_at(const std::string& bytes, std::size_t offset) {
  return load<T>(bytes.data() + offset, std::endian::little);
}

/// Opcodes of the records from an offset to the footer.
std::vector<int> opcodes(const std::string& bytes, std::size_t offset) {
  std::vector<int> found;
  while (offset + kRecordHeaderBytes <= bytes.size() - kMagicBytes) {
    found.push_back(bytes[offset]);
    offset += kRecordHeaderBytes + number_at<std::uint64_t>(bytes, offset + 1);
  }
  EXPECT_EQ(offset, bytes.size() - kMagicBytes);
  return found;
}

std::string written(const std::filesystem::path& path, int num_messages) {
  McapWriter writer(path, 1);
  const McapWriter::Channel a = writer.add_channel("/a", "A", "{}");
  writer.add_channel("/never", "B", "{}");
  for (int i = 0; i < num_messages; ++i) {
    writer.write(a, 1000U + static_cast<std::uint64_t>(i), "\"" + std::string(400'000, 'x') + "\"");
  }
  writer.finish();
  return test::read_bytes(path);
}

TEST(McapWriter, RecordsComeInTheOrderOfTheSpecification) {
  const test::TempFolder folder;
  const std::string bytes = written(folder.path() / "a.mcap", 7);
  const std::string magic("\x89MCAP0\r\n", 8);
  EXPECT_EQ(bytes.substr(0, kMagicBytes), magic);
  EXPECT_EQ(bytes.substr(bytes.size() - kMagicBytes), magic);
  // Header; chunks of three messages (a MiB and what goes beyond), each with an index; end of the data.
  // Summary: schemas, channels, chunk indexes, statistics, an offset for each of the four; footer.
  EXPECT_THAT(opcodes(bytes, kMagicBytes), testing::ElementsAre(1, 6, 7, 6, 7, 6, 7, 15,  //
                                                                3, 3, 4, 4, 8, 8, 8, 11, 14, 14, 14, 14, 2));
}

TEST(McapWriter, ChecksumsAndOffsetsOfTheSummaryFit) {
  const test::TempFolder folder;
  const std::string bytes = written(folder.path() / "a.mcap", 3);
  const std::size_t footer = bytes.size() - kMagicBytes - kFooterBytes;
  const auto summary = number_at<std::uint64_t>(bytes, footer + kRecordHeaderBytes);
  const auto offsets = number_at<std::uint64_t>(bytes, footer + kRecordHeaderBytes + 8);
  const auto checksum = number_at<std::uint32_t>(bytes, footer + kRecordHeaderBytes + 16);
  EXPECT_EQ(crc32(std::string_view(bytes).substr(summary, footer + kRecordHeaderBytes + 16 - summary)),
            checksum);
  EXPECT_EQ(bytes[summary], 3);
  EXPECT_EQ(bytes[offsets], 14);
  constexpr std::size_t kDataEndBytes = kRecordHeaderBytes + 4;
  EXPECT_EQ(crc32(std::string_view(bytes).substr(0, summary - kDataEndBytes)),
            number_at<std::uint32_t>(bytes, summary - 4));
}

TEST(McapWriter, WithoutMessagesTheFileIsStillWhole) {
  const test::TempFolder folder;
  const std::string bytes = written(folder.path() / "a.mcap", 0);
  EXPECT_THAT(opcodes(bytes, kMagicBytes),
              testing::ElementsAre(1, 6, 15, 3, 3, 4, 4, 8, 11, 14, 14, 14, 14, 2));
}

/// What the reference reader finds in a file, or nothing where it is not installed.
std::optional<nlohmann::json> read_with_reference(const std::filesystem::path& file) {
  const char* const source = std::getenv("MLO_SOURCE_DIR");
  const std::filesystem::path reader =
      std::filesystem::path(source == nullptr ? "." : source) / "tests/scene/mcap_reader";
  if (!std::filesystem::exists(reader / "node_modules/@mcap/core")) return std::nullopt;
  const std::string out = file.string() + ".json";
  const std::string command =
      "node '" + (reader / "check.cjs").string() + "' '" + file.string() + "' > '" + out + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return nlohmann::json::parse(test::read_bytes(out));
}

TEST(Mcap, TheReferenceReaderFindsAllChannels) {
  const test::TempFolder folder;
  const std::filesystem::path path = folder.path() / "scene.mcap";
  test::write_small_scene(folder.path() / "scene.mlo", 4);
  export_mcap(SceneFile(folder.path() / "scene.mlo"), path);
  const std::optional<nlohmann::json> found = read_with_reference(path);
  if (!found) {
    GTEST_SKIP() << "the reference reader is not there; 'npm install' in tests/scene/mcap_reader gets it";
  }
  const nlohmann::json& topics = found->at("topics");
  const auto expect_topic = [&](const char* topic, const char* schema, int messages) {
    EXPECT_EQ(topics.at(topic).at("schema"), std::string("foxglove.") + schema) << topic;
    EXPECT_EQ(topics.at(topic).at("messages"), messages) << topic;
  };
  expect_topic("/tf", "FrameTransforms", 4);
  expect_topic("/pose", "PoseInFrame", 4);
  expect_topic("/trajectory", "PosesInFrame", 1);
  expect_topic("/points", "PointCloud", 4);
  expect_topic("/objects", "SceneUpdate", 4);
  expect_topic("/map", "PointCloud", 1);
  expect_topic("/object_clouds", "PointCloud", 1);
  EXPECT_EQ(topics.at("/points").at("points"), 4 * test::small_cloud(0).points.size());
  EXPECT_EQ(topics.at("/map").at("points"), test::small_map().size());
  EXPECT_EQ(topics.at("/object_clouds").at("points"), test::small_shape().points.size());
  EXPECT_EQ(topics.at("/objects").at("boxes"), 4);
  EXPECT_EQ(found->at("start_ns"), "100000000000");
  EXPECT_EQ(found->at("end_ns"), "100300000000");
  const std::vector<double> first = found->at("firstCloud").at("/points");
  EXPECT_NEAR(first[2], -1.7, 0.004);
}

}  // namespace
}  // namespace mlo
