#include "mlo/simulator/simulate.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "apps/mlo/commands.hpp"
#include "apps/mlo/config_options.hpp"
#include "apps/mlo/progress.hpp"

namespace mlo::apps {
namespace {

using simulator::Layout;
using simulator::SceneKind;
using simulator::SimulationOptions;
using simulator::SimulationReport;

struct Options {
  SimulationOptions simulation;
  bool compensated = false;
  ConfigArguments config;
  std::filesystem::path out;
};

/// Every field of a struct of numbers as an option --<prefix>-<name>.
struct OptionVisitor {
  CLI::App& command;
  std::string prefix, group;

  template <class T, class Check>
  void operator()(const std::string& name, T& value, const Check& check, const std::string& meaning) {
    std::string flag = "--" + prefix + "-" + name;
    std::replace(flag.begin(), flag.end(), '_', '-');
    command.add_option(flag, value, meaning)
        ->check(CLI::Range(check.min, check.max))
        ->capture_default_str()
        ->group(group);
  }
};

void run(Options options) {
  SimulationOptions& simulation = options.simulation;
  simulation.version = MLO_VERSION;
  if (options.compensated) simulation.layout = Layout::odometry;
  PipelineConfig base;
  base.sensor = simulator::default_sensor();
  simulation.sensor = resolve(options.config, base).sensor;
  std::unique_ptr<Progress> progress;
  const auto show = [&](std::size_t done, std::size_t total) {
    if (!progress) progress = std::make_unique<Progress>("scans", total);
    progress->update(done);
  };
  const SimulationReport report = simulator::simulate(simulation, options.out, show);
  if (progress) progress->finish();
  std::cout << fmt::format(
      "{}: {} scans, {} points each on average, {:.0f} m, {} objects met, {} map points\n"
      "All of it is synthetic: see {}\n",
      options.out.string(), report.scans, report.points / std::max<std::size_t>(1, report.scans),
      report.way_m, report.objects, report.map_points, (options.out / "README.txt").string());
}

}  // namespace

void add_simulate(CLI::App& program) {
  auto* command =
      program.add_subcommand("simulate", "Write a simulated drive with exact truth in a KITTI layout");
  const auto options = std::make_shared<Options>();
  SimulationOptions& simulation = options->simulation;
  std::map<std::string, SceneKind> scenes;
  std::string names;
  for (const auto& [name, kind] : simulator::kScenes) {
    scenes.emplace(name, kind);
    names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
  }
  command->add_option("--scene", simulation.scene.kind, "What to drive through: " + names)
      ->transform(CLI::CheckedTransformer(scenes).description(""))
      ->type_name("NAME")
      ->required();
  command->add_option("--out", options->out, "Folder to write; must be empty or new")
      ->type_name("DIR")
      ->required();
  command->add_option("--length", simulation.scene.length_m, "Way of the robot [m]")->capture_default_str();
  command->add_option("--seed", simulation.scene.seed, "The same seed gives the same bytes")
      ->capture_default_str();
  command->add_option("--scans", simulation.max_scans, "Stop after this many scans; 0: the whole way")
      ->capture_default_str();
  auto* layout =
      command
          ->add_option("--layout", simulation.layout,
                       "KITTI's layout: tracking (raw scans) or odometry (compensated)")
          ->transform(CLI::CheckedTransformer(std::map<std::string, Layout>{{"tracking", Layout::tracking},
                                                                            {"odometry", Layout::odometry}})
                          .description(""))
          ->type_name("NAME");
  command
      ->add_flag("--compensated", options->compensated,
                 "Motion-compensated scans: the same as --layout odometry")
      ->excludes(layout);
  command->add_flag("--overwrite", simulation.overwrite, "Replace an earlier simulation in the folder");
  command->add_option("--map-voxel", simulation.map_voxel_m, "Spacing of the true map's points [m]")
      ->capture_default_str();
  add_config_options(*command, options->config);
  OptionVisitor lidar{*command, "lidar", "Errors of the simulated lidar"};
  simulation.errors.fields(lidar);
  OptionVisitor detector{*command, "detector", "Errors of the simulated detector"};
  simulation.detector.fields(detector);
  command->footer(R"(
Writes scans, calibration, labels, detections (with and without errors), point labels, true poses at the start, stamp
and end of each sweep, all objects, and the true static map; README.txt in the folder says what is what. The lidar is
KITTI's HDL-64E unless the configuration (--preset, --config, --set) changes its sensor section.

Examples:
  mlo simulate --scene city --length 300 --seed 7 --out city
  mlo simulate --scene city --length 100 --compensated --out city_odometry
  mlo simulate --scene tunnel --preset os1-64 --lidar-range-noise-m 0.01 --out tunnel
  mlo simulate --scene city --detector-miss-share 0.2 --detector-false-positives 2 --out bad_detector)");
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
