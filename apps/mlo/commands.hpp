#pragma once

#include <CLI/CLI.hpp>

namespace mlo::apps {

// Each adds one subcommand, with its options, help and examples, to the program; its callback does the work
// and throws CLI::RuntimeError(exit code) or mlo::InputError to end with an error.
void add_simulate(CLI::App& program);  // only with MLO_WITH_SIMULATOR

}  // namespace mlo::apps
