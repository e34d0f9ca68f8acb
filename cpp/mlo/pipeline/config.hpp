#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mlo/core/sensor.hpp"

namespace mlo {

/// Everything that can be configured, stage by stage.
struct PipelineConfig {
  SensorConfig sensor;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit.group("sensor", sensor, "The lidar that took the scans.");
  }
};

/// Where a configuration comes from, in the order in which it is applied: later ones win.
struct ConfigArguments {
  std::vector<std::string> presets = {};
  std::optional<std::filesystem::path> file = {};
  std::vector<std::string> settings = {};  ///< "key=value"
};

/// `base` changed by presets, file and settings, and checked as a whole.
/// @throws InputError naming preset or file and line, key, value, what is allowed, and the nearest known name
PipelineConfig resolve(const ConfigArguments& arguments, const PipelineConfig& base = {});

/// The whole configuration as commented YAML; resolve() of it as a file gives the same configuration.
std::string to_yaml(PipelineConfig config);

}  // namespace mlo
