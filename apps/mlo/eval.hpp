#pragma once

#include <CLI/CLI.hpp>

namespace mlo::apps {

// Each adds one kind of evaluation to `mlo eval`, as the functions of commands.hpp do to the program.
void add_eval_trajectory(CLI::App& eval);
void add_eval_detection(CLI::App& eval);
void add_eval_tracking(CLI::App& eval);
void add_eval_map(CLI::App& eval);
void add_eval_objects(CLI::App& eval);

}  // namespace mlo::apps
