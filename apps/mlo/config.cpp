#include "mlo/pipeline/config.hpp"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "apps/mlo/commands.hpp"
#include "apps/mlo/config_options.hpp"
#include "mlo/core/error.hpp"
#include "mlo/pipeline/presets.hpp"

namespace mlo::apps {
namespace {

struct Options {
  ConfigArguments arguments;
  bool list_presets = false;
  std::optional<std::filesystem::path> out;
};

void run(const Options& options) {
  if (options.list_presets) {
    for (const Preset& preset : all_presets())
      std::cout << fmt::format("{:<12}{}\n", preset.name, preset.summary);
    return;
  }
  const std::string text = to_yaml(resolve(options.arguments));
  if (!options.out) {
    std::cout << text;
    return;
  }
  std::ofstream file(*options.out);
  file << text;
  file.close();
  if (!file) {
    throw InputError(fmt::format("{}: cannot be written; does the folder exist?", options.out->string()));
  }
}

}  // namespace

void add_config(CLI::App& program) {
  auto* command = program.add_subcommand("config", "Print, check and combine configurations");
  const auto options = std::make_shared<Options>();
  add_config_options(*command, options->arguments);
  command->add_flag("--list-presets", options->list_presets, "List the presets and stop");
  command->add_option("--out", options->out, "Write to this file instead of stdout")->type_name("FILE");
  command->footer(R"(
Presets, file and settings are applied in this order; the result is checked and printed as YAML with
the meaning, unit and allowed range of each value. --config reads it back.

Examples:
  mlo config --list-presets
  mlo config --preset vlp16 --out robot.yaml
  mlo config --config robot.yaml --set sensor.max_range_m=80)");
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
