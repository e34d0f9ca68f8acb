#include "mlo/reproduction/reproduce.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/mlo/commands.hpp"
#include "apps/mlo/progress.hpp"
#include "mlo/core/error.hpp"

namespace mlo::apps {
namespace {

constexpr int kInterrupted = 4;  // exit code, see main.cpp

struct Options {
  std::filesystem::path root;
  ReproduceOptions reproduce;
  std::vector<std::string> tables;
};

// Signal handlers may touch nothing but this.
std::atomic<bool> stop_requested{false};

void require_data(const KittiData& data, const std::filesystem::path& root) {
  if (!data.odometry.empty() || !data.raw.empty() || !data.tracking.empty() || data.labels) return;
  throw InputError(fmt::format(
      "{}: no KITTI data; looked up to two folders deep for sequences/NN/velodyne (odometry), "
      "DATE_drive_NNNN_sync/velodyne_points (raw) and training/velodyne or training/label_02 (tracking)",
      root.string()));
}

void run(const Options& options) {
  const KittiData data = find_kitti(options.root);
  require_data(data, options.root);
  const PaperTables paper = paper_tables();
  std::signal(SIGINT, [](int) { stop_requested = true; });
  std::signal(SIGTERM, [](int) { stop_requested = true; });
  std::optional<Progress> progress;
  const ReproduceProgress display{.on_run =
                                      [&](const std::string& name) {
                                        progress.reset();
                                        spdlog::info("{}", name);
                                      },
                                  .on_scan =
                                      [&](std::size_t done, std::size_t total) {
                                        if (!progress) progress.emplace("scans", total);
                                        progress->update(done);
                                      },
                                  .should_stop = [] { return stop_requested.load(); }};
  std::cout << fmt::format("paper: {}\n", paper.source);
  for (const PaperTable& table : paper.tables) {
    const bool wanted = options.tables.empty() || std::find(options.tables.begin(), options.tables.end(),
                                                            table.name) != options.tables.end();
    if (!wanted || stop_requested) continue;
    const ReproducedTable result = reproduce_table(table, data, options.reproduce, display);
    progress.reset();
    std::cout << "\n" << to_text(result) << std::flush;
  }
  if (!stop_requested) return;
  spdlog::warn("stopped early: the same command goes on with the run that was left");
  throw CLI::RuntimeError(kInterrupted);
}

}  // namespace

void add_reproduce(CLI::App& program) {
  auto* command = program.add_subcommand("reproduce", "The paper's tables, beside its numbers");
  const auto options = std::make_shared<Options>();
  options->reproduce.out = "reproduction";
  command->add_option("root", options->root, "Where KITTI's data lies")->required()->type_name("ROOT");
  command
      ->add_option("--out", options->reproduce.out,
                   "Folder for the runs, one folder each; finished ones are not repeated")
      ->type_name("DIR")
      ->capture_default_str();
  command->add_option("--table", options->tables, "Only these: 'Table I' ... 'Table IV', 'Fig. 7'")
      ->check(CLI::IsMember({"Table I", "Table II", "Table III", "Table IV", "Fig. 7"}));
  command->add_option(
      "--last-frame", options->reproduce.last_frame,
      "Run no farther than this frame, to try things out: the errors are not the table's then");
  command->footer(R"(
Finds which of the paper's sequences ROOT holds (KITTI odometry, raw and tracking in any arrangement up to two folders
deep), runs what its tables need, and prints each with the paper's values beside those of this program. What is missing
is named. Raw drives are judged by smoothed inertial records ('mlo truth'), as in the paper.

Examples:
  mlo reproduce kitti --out out/reproduction
  mlo reproduce kitti --table 'Table I' --table 'Table III')");
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
