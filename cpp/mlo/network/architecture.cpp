#include "mlo/network/architecture.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

using nlohmann::json;

constexpr const char* kPlace = "architecture of the network";

[[noreturn]] void refuse(const std::string& fault) {
  throw InputError(fmt::format(
      "{}: {}; take the weights from 'mlo train' or scripts/convert_3dssd_checkpoint.py", kPlace, fault));
}

void require(bool holds, const std::string& fault) {
  if (!holds) refuse(fault);
}

// --- from JSON

std::vector<int> channels_from(const json& node) {
  return node.get<std::vector<int>>();
}

Eigen::Vector3d vector_from(const json& node) {
  require(node.size() == 3, "a vector has not three numbers");
  return {node[0].get<double>(), node[1].get<double>(), node[2].get<double>()};
}

NetworkInputSpec input_from(const json& node) {
  NetworkInputSpec input;
  input.max_points = node.at("max_points").get<int>();
  input.features.clear();
  for (const json& feature : node.at("features")) {
    const auto name = feature.get<std::string>();
    require(name == "intensity" || name == "height", "unknown feature '" + name + "'");
    input.features.push_back(name == "height" ? PointFeature::height : PointFeature::intensity);
  }
  input.max_range_m = node.at("max_range_m").get<double>();
  input.min_height_m = node.at("min_height_m").get<double>();
  input.max_height_m = node.at("max_height_m").get<double>();
  input.sensor_height_m = node.at("sensor_height_m").get<double>();
  const auto ground = node.at("ground").get<std::string>();
  require(ground == "kept" || ground == "removed", "input.ground is neither 'kept' nor 'removed'");
  input.keeps_ground = ground == "kept";
  input.half_angle_deg = node.at("half_angle_deg").get<double>();
  input.rings = node.value("rings", 0);
  return input;
}

SamplingSpec sampling_from(const json& node) {
  SamplingSpec sampling;
  const auto method = node.at("method").get<std::string>();
  require(method == "distance" || method == "feature", "unknown sampling method '" + method + "'");
  sampling.method = method == "feature" ? SamplingSpec::Method::feature : SamplingSpec::Method::distance;
  sampling.count = node.at("count").get<int>();
  sampling.from = node.value("from", 0);
  sampling.to = node.value("to", -1);
  return sampling;
}

SetAbstractionSpec layer_from(const json& node) {
  SetAbstractionSpec layer;
  for (const json& sampling : node.value("samples", json::array())) {
    layer.samples.push_back(sampling_from(sampling));
  }
  for (const json& scale : node.at("scales")) {
    layer.scales.push_back({.inner_radius_m = scale.value("inner_radius_m", 0.0),
                            .radius_m = scale.at("radius_m").get<double>(),
                            .neighbours = scale.at("neighbours").get<int>(),
                            .channels = channels_from(scale.at("channels"))});
  }
  layer.aggregate = node.value("aggregate", 0);
  return layer;
}

BoxCodeSpec box_code_from(const json& node) {
  BoxCodeSpec code;
  const auto center = node.at("center").get<std::string>();
  const auto size = node.at("size").get<std::string>();
  require(center == "mean_size" || center == "metres", "box_code.center is neither 'mean_size' nor 'metres'");
  require(size == "log_mean" || size == "half", "box_code.size is neither 'log_mean' nor 'half'");
  code.center_in_sizes = center == "mean_size";
  code.log_size = size == "log_mean";
  code.angle_bins = node.at("angle_bins").get<int>();
  code.first_angle_rad = node.at("first_angle_rad").get<double>();
  return code;
}

// --- checks

bool are_positive(const std::vector<int>& channels) {
  return std::ranges::all_of(channels, [](int channel) { return channel > 0; });
}

void check_scales(const SetAbstractionSpec& layer, const char* where) {
  require(!layer.scales.empty(), fmt::format("{} has no scales", where));
  for (const ScaleSpec& scale : layer.scales) {
    require(scale.radius_m > scale.inner_radius_m && scale.inner_radius_m >= 0.0 && scale.neighbours > 0 &&
                !scale.channels.empty() && are_positive(scale.channels),
            fmt::format("{} has a scale without radius, neighbours or channels", where));
  }
  require(layer.aggregate >= 0, fmt::format("{} has a negative 'aggregate'", where));
}

void check(const NetworkArchitecture& architecture) {
  require(
      !architecture.classes.empty() && architecture.classes.size() == architecture.mean_sizes_lwh_m.size(),
      "classes and mean_sizes_lwh_m are not as many");
  for (const Eigen::Vector3d& size : architecture.mean_sizes_lwh_m) {
    require(size.minCoeff() > 0.0, "a mean size is not positive");
  }
  const NetworkInputSpec& input = architecture.input;
  require(input.max_points > 0 && input.max_range_m > 0.0 && input.min_height_m < input.max_height_m,
          "its input has no extent");
  require(!architecture.layers.empty(), "it has no layers");
  for (const SetAbstractionSpec& layer : architecture.layers) {
    check_scales(layer, "a layer");
    require(!layer.samples.empty(), "a layer samples no points");
    for (const SamplingSpec& sampling : layer.samples) {
      require(sampling.count > 0 && sampling.from >= 0, "a layer samples no points");
    }
  }
  check_scales(architecture.candidate_layer, "candidate_layer");
  require(architecture.vote.candidates > 0 && architecture.box_code.angle_bins > 0,
          "it has no candidates or no angle bins");
  const HeadSpec& head = architecture.head;
  require(are_positive(architecture.vote.channels) && are_positive(head.shared) &&
              are_positive(head.classes) && are_positive(head.boxes),
          "a layer of vote or head has no channels");
}

// --- to JSON

json to_node(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

json to_node(const SetAbstractionSpec& layer) {
  json node = {{"aggregate", layer.aggregate}, {"scales", json::array()}};
  for (const ScaleSpec& scale : layer.scales) {
    node["scales"].push_back({{"inner_radius_m", scale.inner_radius_m},
                              {"radius_m", scale.radius_m},
                              {"neighbours", scale.neighbours},
                              {"channels", scale.channels}});
  }
  for (const SamplingSpec& sampling : layer.samples) {
    node["samples"].push_back(
        {{"method", sampling.method == SamplingSpec::Method::feature ? "feature" : "distance"},
         {"count", sampling.count},
         {"from", sampling.from},
         {"to", sampling.to}});
  }
  return node;
}

json to_node(const NetworkInputSpec& input) {
  json node = {{"max_points", input.max_points},
               {"features", json::array()},
               {"max_range_m", input.max_range_m},
               {"min_height_m", input.min_height_m},
               {"max_height_m", input.max_height_m},
               {"sensor_height_m", input.sensor_height_m},
               {"ground", input.keeps_ground ? "kept" : "removed"},
               {"half_angle_deg", input.half_angle_deg},
               {"rings", input.rings}};
  for (const PointFeature feature : input.features) {
    node["features"].push_back(feature == PointFeature::height ? "height" : "intensity");
  }
  return node;
}

}  // namespace

int channels_out(const SetAbstractionSpec& layer) {
  if (layer.aggregate > 0) return layer.aggregate;
  int sum = 0;
  for (const ScaleSpec& scale : layer.scales) sum += scale.channels.back();
  return sum;
}

NetworkArchitecture parse_architecture(std::string_view text) {
  NetworkArchitecture architecture;
  try {
    const json node = json::parse(text);
    for (const json& name : node.at("classes")) {
      const std::optional<ObjectClass> known = object_class_from(name.get<std::string>());
      if (!known) refuse("unknown class '" + name.get<std::string>() + "'");
      architecture.classes.push_back(*known);
    }
    for (const json& size : node.at("mean_sizes_lwh_m")) {
      architecture.mean_sizes_lwh_m.push_back(vector_from(size));
    }
    architecture.batch_norm_eps = node.value("batch_norm_eps", architecture.batch_norm_eps);
    architecture.input = input_from(node.at("input"));
    for (const json& layer : node.at("layers")) architecture.layers.push_back(layer_from(layer));
    const json& vote = node.at("vote");
    architecture.vote = {.candidates = vote.at("candidates").get<int>(),
                         .channels = channels_from(vote.at("channels")),
                         .max_shift_m = vector_from(vote.at("max_shift_m"))};
    architecture.candidate_layer = layer_from(node.at("candidate_layer"));
    const json& head = node.at("head");
    architecture.head = {.shared = channels_from(head.at("shared")),
                         .classes = channels_from(head.at("classes")),
                         .boxes = channels_from(head.at("boxes"))};
    architecture.box_code = box_code_from(node.at("box_code"));
  } catch (const json::exception& e) {
    refuse(fmt::format("it cannot be read ({})", e.what()));
  }
  check(architecture);
  return architecture;
}

std::string to_json(const NetworkArchitecture& architecture) {
  json node = {{"batch_norm_eps", architecture.batch_norm_eps},
               {"input", to_node(architecture.input)},
               {"vote",
                {{"candidates", architecture.vote.candidates},
                 {"channels", architecture.vote.channels},
                 {"max_shift_m", to_node(architecture.vote.max_shift_m)}}},
               {"candidate_layer", to_node(architecture.candidate_layer)},
               {"head",
                {{"shared", architecture.head.shared},
                 {"classes", architecture.head.classes},
                 {"boxes", architecture.head.boxes}}},
               {"box_code",
                {{"center", architecture.box_code.center_in_sizes ? "mean_size" : "metres"},
                 {"size", architecture.box_code.log_size ? "log_mean" : "half"},
                 {"angle_bins", architecture.box_code.angle_bins},
                 {"first_angle_rad", architecture.box_code.first_angle_rad}}}};
  for (const ObjectClass object_class : architecture.classes) {
    node["classes"].push_back(std::string(to_string(object_class)));
  }
  for (const Eigen::Vector3d& size : architecture.mean_sizes_lwh_m) {
    node["mean_sizes_lwh_m"].push_back(to_node(size));
  }
  for (const SetAbstractionSpec& layer : architecture.layers) node["layers"].push_back(to_node(layer));
  return node.dump();
}

NetworkArchitecture small_architecture() {
  using enum SamplingSpec::Method;
  NetworkArchitecture small;
  small.classes = {ObjectClass::car, ObjectClass::van, ObjectClass::truck, ObjectClass::pedestrian,
                   ObjectClass::cyclist};
  small.mean_sizes_lwh_m = {
      {4.2, 1.75, 1.5}, {5.0, 1.9, 2.1}, {8.5, 2.5, 3.2}, {0.7, 0.6, 1.7}, {1.8, 0.6, 1.7}};
  small.input = {
      .max_points = 8192, .max_range_m = 50.0, .min_height_m = -0.3, .max_height_m = 3.0, .rings = 64};
  small.layers = {{.samples = {{.method = distance, .count = 1536}},
                   .scales = {{.radius_m = 0.5, .neighbours = 16, .channels = {16, 32}},
                              {.radius_m = 1.0, .neighbours = 16, .channels = {16, 32}}}},
                  {.samples = {{.method = feature, .count = 288}, {.method = distance, .count = 224}},
                   .scales = {{.radius_m = 1.0, .neighbours = 16, .channels = {32, 64}},
                              {.radius_m = 2.0, .neighbours = 24, .channels = {32, 64}}},
                   .aggregate = 96},
                  {.samples = {{.method = feature, .count = 192, .from = 0, .to = 288},
                               {.method = distance, .count = 128, .from = 288, .to = -1}},
                   .scales = {{.radius_m = 2.0, .neighbours = 16, .channels = {64, 96}},
                              {.radius_m = 4.8, .neighbours = 24, .channels = {64, 96}}},
                   .aggregate = 128}};
  small.vote = {.candidates = 192, .channels = {64}, .max_shift_m = {4.0, 4.0, 2.0}};
  small.candidate_layer = {.scales = {{.radius_m = 3.0, .neighbours = 16, .channels = {128, 128}},
                                      {.radius_m = 6.0, .neighbours = 20, .channels = {128, 128}}}};
  small.head = {.shared = {128}, .classes = {64}, .boxes = {64}};
  return small;
}

}  // namespace mlo
