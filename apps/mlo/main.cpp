#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <malloc.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "apps/mlo/commands.hpp"
#include "mlo/core/error.hpp"
#include "mlo/pipeline/config_io.hpp"

namespace {

enum ExitCode { kDone = 0, kBadInput = 1, kBadUsage = 2, kBug = 3 };  // 4: see run.cpp

// Scans come and go ten times a second with megabytes each. By default the C library gives such blocks back
// to the system and gets them anew, page fault by page fault, which costs more than the work done on them.
void keep_freed_memory() {
  constexpr int kBytes = 32 * 1024 * 1024;  // the largest threshold that is allowed
  mallopt(M_MMAP_THRESHOLD, kBytes);
  mallopt(M_TRIM_THRESHOLD, 8 * kBytes);
  mallopt(M_TOP_PAD, kBytes / 8);
}

constexpr const char* kFooter = R"(
Results go to stdout, messages and progress to stderr.

Exit codes:
  0  done
  1  the input or the configuration cannot be used
  2  wrong usage
  3  a bug in mlo
  4  stopped early by a signal; what was finished is on disk

Examples:
  mlo config --list-presets
  mlo config --preset hdl64e --set sensor.max_range_m=80
  mlo config --help)";

void add_global_options(CLI::App& program) {
  program.set_version_flag("--version", MLO_VERSION);
  auto* quiet = program.add_flag_callback(
      "-q,--quiet", [] { spdlog::set_level(spdlog::level::err); }, "Only errors; no progress");
  program
      .add_flag_callback(
          "-v,--verbose", [] { spdlog::set_level(spdlog::level::debug); }, "More messages")
      ->excludes(quiet);
}

#ifndef MLO_WITH_TORCH
void add_missing_train(CLI::App& program) {
  auto* command =
      program.add_subcommand("train", "Train the network of the detector 3dssd (not in this build)");
  command->footer("Examples:\n  mlo train --help    # in a build with -DMLO_WITH_TORCH=ON");
  command->allow_extras();
  command->callback([] {
    throw mlo::InputError(
        "this mlo was built without training: install libtorch-dev and libopenblas0-pthread "
        "(scripts/install_dependencies.sh torch) and configure with -DMLO_WITH_TORCH=ON");
  });
}
#endif

/// The first word that is neither an option nor a subcommand, when no subcommand was given.
std::string unknown_command(const CLI::App& program, const std::vector<std::string>& arguments) {
  if (!program.get_subcommands().empty()) return {};
  for (const std::string& argument : arguments) {
    if (!argument.empty() && argument.front() != '-') return argument;
  }
  return {};
}

void report_usage_error(const CLI::App& program, const std::vector<std::string>& arguments,
                        const CLI::ParseError& error) {
  const std::string word = unknown_command(program, arguments);
  if (word.empty()) {
    const auto used = program.get_subcommands();
    std::cerr << fmt::format("mlo: {}\nSee 'mlo {}--help'.\n", error.what(),
                             used.empty() ? "" : used.front()->get_name() + " ");
    return;
  }
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands({})) names.push_back(command->get_name());
  const std::string suggestion = mlo::nearest(word, names);
  std::cerr << fmt::format("mlo: there is no subcommand '{}'{}\nSee 'mlo --help'.\n", word,
                           suggestion.empty() ? "" : fmt::format("; did you mean '{}'?", suggestion));
}

int run(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("mlo"));
  spdlog::set_pattern("%^%l%$: %v");

  CLI::App program{
      "MLO: multi-object lidar odometry. From the scans of one spinning lidar to trajectories, tracks and "
      "maps.",
      "mlo"};
  program.require_subcommand(1);
  program.fallthrough();  // global options may follow the subcommand
  program.footer(kFooter);
  add_global_options(program);
  mlo::apps::add_run(program);
  mlo::apps::add_detect(program);
  mlo::apps::add_track(program);
  mlo::apps::add_eval(program);
  mlo::apps::add_config(program);
  mlo::apps::add_info(program);
  mlo::apps::add_truth(program);
  mlo::apps::add_report(program);
  mlo::apps::add_scene(program);
  mlo::apps::add_export(program);
  mlo::apps::add_reproduce(program);
#ifdef MLO_WITH_SIMULATOR
  mlo::apps::add_simulate(program);
#endif
#ifdef MLO_WITH_TORCH
  mlo::apps::add_train(program);
#else
  add_missing_train(program);
#endif

  try {
    program.parse(argc, argv);
  } catch (const CLI::RuntimeError& e) {
    return e.get_exit_code();
  } catch (const CLI::Success& e) {  // --help, --version
    return program.exit(e);
  } catch (const CLI::ParseError& e) {
    report_usage_error(program, {argv + 1, argv + argc}, e);
    return kBadUsage;
  } catch (const mlo::InputError& e) {
    spdlog::error("{}", e.what());
    return kBadInput;
  }
  return kDone;
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow further is an error that is told, not the end
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "critical: internal error: %s\n", e.what());
  } catch (...) {
    std::fputs("critical: internal error\n", stderr);
  }
  return kBug;
}
