#include "apps/mlo/eval.hpp"

#include "apps/mlo/commands.hpp"

namespace mlo::apps {
namespace {

constexpr const char* kExamples = R"(Examples:
  mlo eval trajectory --truth truth_lidar/01.txt --estimate out/trajectory.txt
  mlo eval map --cloud out/static_map.ply
  mlo eval objects --truth city/truth/objects.csv --estimate out/objects.csv
  mlo eval detection --truth city/truth/objects.csv --truth-poses city/truth/poses_stamp.txt --estimate boxes.csv
  mlo eval tracking --truth training/label_02 --estimate out/tracks
)";

}  // namespace

void add_eval(CLI::App& program) {
  CLI::App* eval = program.add_subcommand("eval", "Measure results against the truth");
  eval->require_subcommand(1);
  eval->footer(kExamples);
  add_eval_trajectory(*eval);
  add_eval_detection(*eval);
  add_eval_tracking(*eval);
  add_eval_objects(*eval);
  add_eval_map(*eval);
}

}  // namespace mlo::apps
