#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/mlo/commands.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/true_poses.hpp"
#include "mlo/report/page.hpp"

namespace mlo::apps {
namespace {

struct Options {
  std::vector<std::filesystem::path> runs;
  std::filesystem::path out = "report.html";
  std::vector<std::filesystem::path> truths;
  std::filesystem::path calibration;
};

struct Truth {
  PoseList poses;
  std::string name;
};

// The truth that belongs to the scans of a run, where they are still there.
std::optional<Truth> truth_of_input(const RunFolder& run) {
  if (run.input_folder.empty() || !std::filesystem::exists(run.input_folder)) return std::nullopt;
  try {
    const Dataset dataset = open_dataset(run.input_folder, {.sequence = run.input_sequence});
    if (dataset.truth) return Truth{*dataset.truth, dataset.format + "'s own"};
  } catch (const InputError& error) {
    spdlog::warn("no truth for {}: {}", run.name, error.what());
  }
  return std::nullopt;
}

std::optional<Truth> find_truth(const Options& options, std::size_t index, const RunFolder& run) {
  if (options.truths.empty()) return truth_of_input(run);
  const std::filesystem::path& file = options.truths[options.truths.size() == 1 ? 0 : index];
  return Truth{read_true_poses(file, options.calibration), file.filename().string()};
}

ReportedRun reported(const Options& options, std::size_t index) {
  ReportedRun run{.run = read_run_folder(options.runs[index]), .errors = {}, .truth_name = {}};
  const std::optional<Truth> truth = find_truth(options, index, run.run);
  if (!truth) return run;
  const PoseList& estimate = run.run.trajectory;
  PoseMatching matching = match_poses({truth->poses.frames, {}, truth->poses.T_world_body},
                                      {estimate.frames, {}, estimate.T_world_body}, MatchBy::frame);
  if (matching.pairs.empty()) {
    spdlog::warn("{}: no pose has the frame number of a true one; its errors are left out", run.run.name);
    return run;
  }
  TrajectoryErrors errors = trajectory_errors(matching);
  run.errors = TrajectoryEvaluation{run.run.name, std::move(matching), std::move(errors)};
  run.truth_name = truth->name;
  return run;
}

void run(const Options& options) {
  if (options.truths.size() > 1 && options.truths.size() != options.runs.size()) {
    throw CLI::ValidationError("--truth", "give one for all runs, or one for each");
  }
  std::vector<ReportedRun> runs;
  for (std::size_t i = 0; i < options.runs.size(); ++i) runs.push_back(reported(options, i));
  const std::string page = report_page(runs);
  write_file_atomically(options.out, page);
  std::cout << fmt::format("{}: {} {}, {:.1f} MB\n", options.out.string(), runs.size(),
                           runs.size() == 1 ? "run" : "runs", 1e-6 * static_cast<double>(page.size()));
}

}  // namespace

void add_report(CLI::App& program) {
  auto* command = program.add_subcommand("report", "One HTML page about one run, or several side by side");
  const auto options = std::make_shared<Options>();
  command->add_option("runs", options->runs, "Folders that 'mlo run --out' wrote")
      ->required()
      ->type_name("DIR");
  command->add_option("--out", options->out, "The page")->type_name("FILE")->capture_default_str();
  command
      ->add_option("--truth", options->truths,
                   "True poses: one for all runs, or one for each (default: those that come with the scans)")
      ->type_name("FILE");
  command
      ->add_option("--calib", options->calibration,
                   "Brings the truth to the lidar, as in 'mlo eval trajectory'")
      ->type_name("FILE");
  command->footer(R"(
The page holds tables, paths and errors, times of each stage, the map from above with path and objects, counters and
warnings. It needs no other file and no network, and can be printed.

Examples:
  mlo report out/04
  mlo report out/04 out/04_paper --out compare.html
  mlo report out/0005 --truth truth/0005/poses.txt --out 0005.html)");
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
