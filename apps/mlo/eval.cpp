#include "apps/mlo/eval.hpp"

#include "apps/mlo/commands.hpp"

namespace mlo::apps {

void add_eval(CLI::App& program) {
  CLI::App* eval = program.add_subcommand("eval", "Measure results against the truth");
  eval->require_subcommand(1);
  add_eval_trajectory(*eval);
}

}  // namespace mlo::apps
