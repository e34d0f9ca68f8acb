#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/network/architecture.hpp"
#include "mlo/network/parameters.hpp"
#include "network/tiny_network.hpp"

namespace mlo {
namespace {

using ::testing::HasSubstr;

TEST(Architecture, JsonAndBackIsTheSame) {
  for (const NetworkArchitecture& architecture : {small_architecture(), test::tiny_architecture()}) {
    const std::string json = to_json(architecture);
    EXPECT_EQ(to_json(parse_architecture(json)), json);
  }
}

// The network of the paper as OpenPCDet's and MMDetection3D's users have it.
TEST(Architecture, ThePublishedNetworkCanBeSaid) {
  const NetworkArchitecture full = parse_architecture(R"json(
{"classes": ["car", "pedestrian", "cyclist"],
 "mean_sizes_lwh_m": [[3.9, 1.6, 1.56], [0.8, 0.6, 1.73], [1.76, 0.6, 1.73]],
 "input": {"max_points": 16384, "features": ["intensity"], "max_range_m": 80, "min_height_m": -1.3,
           "max_height_m": 2.7, "sensor_height_m": 1.73, "ground": "kept", "half_angle_deg": 45},
 "layers": [
  {"samples": [{"method": "distance", "count": 4096}], "aggregate": 64,
   "scales": [{"radius_m": 0.2, "neighbours": 32, "channels": [16, 16, 32]},
              {"radius_m": 0.4, "neighbours": 32, "channels": [16, 16, 32]},
              {"radius_m": 0.8, "neighbours": 64, "channels": [32, 32, 64]}]},
  {"samples": [{"method": "feature", "count": 512}, {"method": "distance", "count": 512}], "aggregate": 128,
   "scales": [{"radius_m": 0.4, "neighbours": 32, "channels": [64, 64, 128]},
              {"radius_m": 0.8, "neighbours": 32, "channels": [64, 64, 128]},
              {"radius_m": 1.6, "neighbours": 64, "channels": [64, 96, 128]}]},
  {"samples": [{"method": "feature", "count": 256, "to": 512}, {"method": "distance", "count": 256, "from": 512}],
   "aggregate": 256,
   "scales": [{"radius_m": 1.6, "neighbours": 32, "channels": [128, 128, 256]},
              {"radius_m": 3.2, "neighbours": 32, "channels": [128, 192, 256]},
              {"radius_m": 4.8, "neighbours": 32, "channels": [128, 256, 256]}]}],
 "vote": {"candidates": 256, "channels": [128], "max_shift_m": [3, 3, 2]},
 "candidate_layer": {"scales": [{"radius_m": 4.8, "neighbours": 16, "channels": [256, 256, 512]},
                                {"radius_m": 6.4, "neighbours": 32, "channels": [256, 512, 1024]}]},
 "head": {"shared": [512, 128], "classes": [128], "boxes": [128]},
 "box_code": {"center": "metres", "size": "half", "angle_bins": 12, "first_angle_rad": 0}})json");
  const NetworkSequences sequences = sequences_of(full);
  EXPECT_EQ(sequences.layers[2].scales[1].channels, (std::vector<int>{131, 128, 192, 256}));
  EXPECT_EQ(sequences.candidates.scales[1].channels, (std::vector<int>{259, 256, 512, 1024}));
  EXPECT_EQ(sequences.shared.channels, (std::vector<int>{1536, 512, 128}));
  EXPECT_EQ(sequences.boxes.channels, (std::vector<int>{128, 128, 30}));
  EXPECT_EQ(weight_name(sequences.layers[0].scales[2], 1), "backbone_3d.SA_modules.0.mlps.2.3");
}

void expect_refusal(const std::string& json, const std::string& word) {
  try {
    parse_architecture(json);
    FAIL() << "taken: " << json;
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr(word));
  }
}

TEST(Architecture, RefusesWhatCannotBe) {
  expect_refusal("{", "cannot be read");
  expect_refusal("{}", "classes");
  std::string json = to_json(small_architecture());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = json;
    changed.replace(changed.find(from), from.size(), to);
    return changed;
  };
  expect_refusal(with("\"car\"", "\"unicorn\""), "unicorn");
  expect_refusal(with("\"height\"", "\"colour\""), "colour");
  expect_refusal(with("\"max_points\":", "\"max_points\":-"), "extent");
  expect_refusal(with("\"method\":\"distance\"", "\"method\":\"random\""), "random");
  expect_refusal(with("\"angle_bins\":12", "\"angle_bins\":0"), "angle bins");
}

TEST(Architecture, RefusesOtherFiles) {
  EXPECT_THROW(architecture_of(TensorFile{}), InputError);
  TensorFile file = test::random_weights(test::tiny_architecture());
  file.metadata[kFormatKey] = "something else";
  EXPECT_THROW(architecture_of(file), InputError);
}

}  // namespace
}  // namespace mlo
