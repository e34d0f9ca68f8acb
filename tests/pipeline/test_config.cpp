#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/pipeline/config.hpp"
#include "mlo/pipeline/presets.hpp"

namespace mlo {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A file with the given text that is gone after the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text) { std::ofstream(path_) << text; }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("mlo_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".yaml");
};

std::string message_of(const ConfigArguments& arguments) {
  try {
    resolve(arguments);
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "accepted";
  return {};
}

TEST(Config, LaterSourcesWin) {
  const TemporaryFile file("sensor:\n  columns: 1024\n  rate_hz: 5\n");
  PipelineConfig base;
  base.sensor.vertical_correction_deg = 0.205;
  const PipelineConfig config =
      resolve({{"hdl64e", "vlp16"}, file.path(), {"sensor.rate_hz=20", "sensor.rate_hz=15"}}, base);
  EXPECT_EQ(config.sensor.name, "VLP-16");
  EXPECT_EQ(config.sensor.rings, 16);
  EXPECT_EQ(config.sensor.columns, 1024);
  EXPECT_EQ(config.sensor.rate_hz, 15.0);
  EXPECT_EQ(config.sensor.vertical_correction_deg, 0.205);
}

TEST(Config, WithoutSourcesIsTheBase) {
  PipelineConfig base;
  base.sensor.rings = 5;
  EXPECT_EQ(to_yaml(resolve({}, base)), to_yaml(base));
}

TEST(Config, PrintedConfigurationReadsBackTheSame) {
  for (const Preset& preset : all_presets()) {
    const PipelineConfig config = resolve({.presets = {std::string(preset.name)}});
    const TemporaryFile file(to_yaml(config));
    EXPECT_EQ(to_yaml(resolve({.file = file.path()})), to_yaml(config)) << preset.name;
  }
}

TEST(Config, MistakesNameTheirSource) {
  EXPECT_THAT(message_of({.presets = {"hdl64"}}),
              AllOf(HasSubstr("unknown preset 'hdl64'"), HasSubstr("did you mean 'hdl64e'?")));
  EXPECT_THAT(message_of({.settings = {"sensor.max_rnge_m=3"}}),
              HasSubstr("did you mean 'sensor.max_range_m'?"));
  EXPECT_THAT(message_of({.file = "/no/such/file.yaml"}), HasSubstr("/no/such/file.yaml"));
}

TEST(Config, RulesBetweenValuesAreChecked) {
  EXPECT_THAT(message_of({.settings = {"sensor.max_range_m=5", "sensor.min_range_m=5"}}),
              HasSubstr("sensor: max_range_m (5) must be larger than min_range_m (5)"));
  EXPECT_THAT(message_of({.settings = {"sensor.min_elevation_deg=30"}}), HasSubstr("min_elevation_deg (30)"));
  EXPECT_THAT(message_of({.settings = {"sensor.beam_elevations_deg=[2, 1]"}}),
              HasSubstr("beam_elevations_deg has 2 entries, but rings is 0"));
  EXPECT_THAT(message_of({.settings = {"sensor.rings=2", "sensor.beam_elevations_deg=[1, 2]"}}),
              HasSubstr("from the highest beam to the lowest"));
}

TEST(Config, RulesHoldForTheResultOnly) {
  const PipelineConfig config = resolve({.settings = {"sensor.min_range_m=200", "sensor.max_range_m=300"}});
  EXPECT_EQ(config.sensor.min_range_m, 200.0);
}

TEST(Config, ValuesOfTheBaseAreChecked) {
  PipelineConfig base;
  base.sensor.rate_hz = 0.0;
  EXPECT_THROW(resolve({}, base), InputError);
}

TEST(Presets, EveryoneResolvesAndHasASummary) {
  ASSERT_FALSE(all_presets().empty());
  for (const Preset& preset : all_presets()) {
    EXPECT_NO_THROW(resolve({.presets = {std::string(preset.name)}})) << preset.name;
    EXPECT_FALSE(preset.summary.empty()) << preset.name;
  }
}

TEST(Presets, AreSortedByName) {
  const auto presets = all_presets();
  EXPECT_TRUE(std::is_sorted(presets.begin(), presets.end(),
                             [](const Preset& a, const Preset& b) { return a.name < b.name; }));
}

TEST(Presets, AreTheFilesOfTheFolder) {
  const char* const root = std::getenv("MLO_SOURCE_DIR");
  ASSERT_NE(root, nullptr);
  std::size_t files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(root) / "config/presets")) {
    std::ifstream stream(entry.path());
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_EQ(find_preset(entry.path().stem().string()).yaml, text);
    ++files;
  }
  EXPECT_EQ(all_presets().size(), files);
}

TEST(Presets, OfSensorsLeaveNothingOfTheSensorBefore) {
  PipelineConfig other;
  other.sensor = {.name = "other",
                  .rings = 3,
                  .beam_elevations_deg = {3.0, 2.0, 1.0},
                  .max_elevation_deg = 3.0,
                  .min_elevation_deg = 1.0,
                  .rate_hz = 77.0,
                  .clockwise = false,
                  .start_azimuth_deg = 12.0,
                  .columns = 77,
                  .min_range_m = 7.0,
                  .max_range_m = 77.0};
  for (const char* const name : {"generic", "hdl32e", "hdl64e", "os1-128", "os1-64", "pandar64", "vlp16"}) {
    EXPECT_EQ(to_yaml(resolve({.presets = {name}}, other)), to_yaml(resolve({.presets = {name}}))) << name;
  }
}

}  // namespace
}  // namespace mlo
