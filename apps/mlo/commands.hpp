#pragma once

#include <CLI/CLI.hpp>

namespace mlo::apps {

// Each adds one subcommand, with its options, help and examples, to the program; its callback does the work
// and throws CLI::RuntimeError(exit code) or mlo::InputError to end with an error. Results go to stdout,
// everything else through spdlog to stderr.
void add_run(CLI::App& program);
void add_detect(CLI::App& program);
void add_track(CLI::App& program);
void add_eval(CLI::App& program);
void add_config(CLI::App& program);
void add_simulate(CLI::App& program);  // only where the simulator is built
void add_train(CLI::App& program);     // only where training is built
void add_info(CLI::App& program);
void add_truth(CLI::App& program);
void add_report(CLI::App& program);
void add_export(CLI::App& program);
void add_scene(CLI::App& program);
void add_reproduce(CLI::App& program);

}  // namespace mlo::apps
