#include "mlo/pipeline/config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mlo/core/error.hpp"
#include "mlo/pipeline/config_io.hpp"
#include "mlo/pipeline/presets.hpp"

namespace mlo {

PipelineConfig resolve(const ConfigArguments& arguments, const PipelineConfig& base) {
  PipelineConfig config = base;
  const ConfigView view = view_config(config);
  for (const std::string& name : arguments.presets) {
    apply_yaml(view, std::string(find_preset(name).yaml), "preset " + name);
  }
  if (arguments.file) apply_yaml_file(view, *arguments.file);
  for (const std::string& setting : arguments.settings) apply_setting(view, setting);

  const std::vector<std::string> problems = find_problems(view);
  if (!problems.empty()) throw InputError(fmt::format("configuration: {}", fmt::join(problems, "; ")));
  return config;
}

std::string to_yaml(PipelineConfig config) {
  return to_yaml(view_config(config));
}

}  // namespace mlo
