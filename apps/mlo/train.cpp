#include <atomic>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/mlo/commands.hpp"
#include "apps/mlo/progress.hpp"
#include "mlo/learning/training.hpp"
#include "mlo/network/architecture.hpp"
#include "mlo/pipeline/config_io.hpp"

namespace mlo::apps {
namespace {

constexpr int kInterrupted = 4;

struct Options {
  TrainingOptions training;
  std::vector<std::string> settings;
  bool list_settings = false;
};

// Signal handlers may touch nothing but this.
std::atomic<bool> stop_requested{false};

std::string row_text(const TrainingRow& row, const std::vector<ObjectClass>& classes) {
  std::string text = fmt::format("step {}: loss {:.3f}", row.step, row.loss.total());
  for (std::size_t k = 0; k < row.ap.size(); ++k) {
    text += fmt::format(", {} AP {:.1f} %", to_string(classes[k]), 100.0 * row.ap[k]);
  }
  return text;
}

/// One bar for loading, one for the steps.
class Display {
 public:
  void operator()(const TrainingProgress& progress) {
    if (progress.phase == TrainingProgress::Phase::judging) return;
    if (!bar_ || phase_ != progress.phase || total_ != progress.total) {
      bar_.reset();
      const bool loads = progress.phase == TrainingProgress::Phase::loading;
      bar_ = std::make_unique<Progress>(loads ? "scans" : "steps", progress.total);
      phase_ = progress.phase;
      total_ = progress.total;
    }
    if (progress.row) {
      bar_->finish();
      spdlog::info("{}", row_text(*progress.row, small_architecture().classes));
    } else {
      bar_->update(progress.done);
    }
  }
  void finish() { bar_.reset(); }

 private:
  std::unique_ptr<Progress> bar_;
  TrainingProgress::Phase phase_ = TrainingProgress::Phase::loading;
  std::size_t total_ = 0;
};

void run(const Options& options) {
  TrainingConfig config;
  const ConfigView view = view_config(config);
  if (options.list_settings) {
    std::cout << to_yaml(view);
    return;
  }
  for (const std::string& setting : options.settings) apply_setting(view, setting);
  if (options.training.folders.empty()) throw CLI::RequiredError("FOLDER");
  if (options.training.out.empty()) throw CLI::RequiredError("--out");
  std::signal(SIGINT, [](int) { stop_requested = true; });
  std::signal(SIGTERM, [](int) { stop_requested = true; });
  Display display;
  const TrainingReport report =
      train(config, options.training, std::ref(display), [] { return stop_requested.load(); });
  display.finish();
  for (const std::string& warning : report.warnings) spdlog::warn("{}", warning);
  std::cout << fmt::format(
      "{} steps on {} scans, judged by {}; results in {}: weights.safetensors, curves.csv, curves.svg\n",
      report.steps, report.examples, report.validation, options.training.out.string());
  if (report.interrupted) {
    spdlog::warn("stopped early; --resume goes on from the last line of curves.csv");
    throw CLI::RuntimeError(kInterrupted);
  }
}

}  // namespace

void add_train(CLI::App& program) {
  auto* command =
      program.add_subcommand("train", "Train the network of the detector 3dssd on labelled scans");
  const auto options = std::make_shared<Options>();
  TrainingOptions& training = options->training;
  command
      ->add_option("folders", training.folders,
                   "Simulated drives, KITTI tracking, raw or object data: whatever has labels")
      ->type_name("FOLDER");
  command->add_option("--out", training.out, "Folder for weights, curves and state; made if missing")
      ->type_name("DIR");
  command->add_option("--validate", training.validation, "Labelled scans to judge by, while training")
      ->type_name("FOLDER");
  command
      ->add_option("--start", training.start,
                   "Weights to begin with instead of random ones; their architecture")
      ->type_name("FILE");
  command->add_flag("--resume", training.resume,
                    "Go on where a training with the same DIR, folders and settings stopped");
  command
      ->add_option("--validate-every", training.validate_every,
                   "Steps between two judgements and saved states")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--validation-scans", training.max_validation,
                   "Judge by so many scans at most, spread over all")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--set", options->settings, "A setting: epochs=20, augmentation.sampling.cars=10")
      ->type_name("KEY=VALUE");
  command->add_flag("--list-settings", options->list_settings, "Print all settings, explained, and end");
  command->footer(R"(
Writes to DIR: weights.safetensors, for --set detection.network.weights=...; curves.csv and curves.svg, losses and
average precision over the steps; training_state.safetensors, for --resume. The same folders, settings and seed give
the same bytes.

Examples:
  mlo train drives/* --validate held_out --out out/network
  mlo train drives/* --validate held_out --out out/network --resume
  mlo train kitti_tracking/training --start 3dssd_small.safetensors --out out/tuned --set epochs=5
  mlo train --list-settings
  mlo run FOLDER --detector 3dssd --set detection.network.weights=out/network/weights.safetensors --out results)");
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
