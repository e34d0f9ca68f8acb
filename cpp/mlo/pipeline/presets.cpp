#include "mlo/pipeline/presets.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/pipeline/config_io.hpp"

namespace mlo {

const Preset& find_preset(std::string_view name) {
  std::vector<std::string> names;
  for (const Preset& preset : all_presets()) {
    if (preset.name == name) return preset;
    names.emplace_back(preset.name);
  }
  const std::string suggestion = nearest(name, names);
  throw InputError(fmt::format("unknown preset '{}'; {}'mlo config --list-presets' lists all", name,
                               suggestion.empty() ? "" : fmt::format("did you mean '{}'? ", suggestion)));
}

}  // namespace mlo
