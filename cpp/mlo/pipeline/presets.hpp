#pragma once

#include <span>
#include <string_view>

namespace mlo {

/// A named part of a configuration, built into the program from config/presets/<name>.yaml.
struct Preset {
  std::string_view name;
  std::string_view summary;  ///< the first comment line of the file
  std::string_view yaml;
};

/// All presets, sorted by name.
std::span<const Preset> all_presets();

/// @throws InputError with the nearest name when there is no such preset
const Preset& find_preset(std::string_view name);

}  // namespace mlo
