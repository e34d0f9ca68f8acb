#pragma once

#include <CLI/CLI.hpp>

#include "mlo/pipeline/config.hpp"

namespace mlo::apps {

/// Adds --preset, --config and --set to a subcommand; resolve(arguments, base) gives the configuration.
/// @param arguments  must outlive the parsing
void add_config_options(CLI::App& command, ConfigArguments& arguments);

}  // namespace mlo::apps
