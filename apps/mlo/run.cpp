#include "mlo/pipeline/run.hpp"

#include <atomic>
#include <charconv>
#include <csignal>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include "apps/mlo/commands.hpp"
#include "apps/mlo/config_options.hpp"
#include "apps/mlo/progress.hpp"
#include "mlo/core/error.hpp"
#include "mlo/pipeline/run_report.hpp"

namespace mlo::apps {
namespace {

constexpr int kInterrupted = 4;  // exit code, see main.cpp

struct Options {
  std::filesystem::path folder;
  OpenOptions open;
  std::vector<std::filesystem::path> detections;
  std::string frames;
  std::string roi;
  std::string detector;
  std::filesystem::path map;
  std::vector<double> start;
  RunOptions run;
  int threads = 0;
  ConfigArguments config;
};

// Signal handlers may touch nothing but this.
std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void parse_frames(const std::string& text, RunOptions& options) {
  if (text.empty()) return;
  const std::size_t colon = text.find(':');
  const auto parse = [&](std::string_view part, std::size_t& value) {
    if (part.empty()) return;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size()) {
      throw CLI::ValidationError("--frames", fmt::format("'{}' is not A:B, as in 0:99, 50: or :99", text));
    }
  };
  if (colon == std::string::npos) {
    parse(text, options.first_frame);
    options.last_frame = options.first_frame;
    return;
  }
  parse(std::string_view(text).substr(0, colon), options.first_frame);
  parse(std::string_view(text).substr(colon + 1), options.last_frame);
}

PipelineConfig configure(const Options& options, const SensorConfig& known_sensor) {
  PipelineConfig base;
  base.sensor = known_sensor;
  ConfigArguments arguments = options.config;
  if (!options.roi.empty()) arguments.settings.push_back("input.roi=" + options.roi);
  if (!options.detector.empty()) arguments.settings.push_back("detection.detector=" + options.detector);
  return resolve(arguments, base);
}

// Rings and times that the data lacks are recovered with the sensor that the user names, if any.
Dataset open(const Options& options) {
  OpenOptions open = options.open;
  const SensorConfig asked = configure(options, {}).sensor;
  if (asked.name != SensorConfig{}.name) open.sensor = asked;
  return open_dataset(options.folder, open);
}

std::string objects_text(const RunSummary& summary) {
  if (summary.boxes_from == "none") return "none looked for";
  const std::string found = fmt::format("{} boxes", summary.detections);
  if (summary.boxes_from == "given") return found + " as given";
  return fmt::format("{} found by the detector '{}'", found, summary.boxes_from);
}

void print_summary(const RunSummary& summary, const std::filesystem::path& out) {
  for (const std::string& warning : summary.warnings) spdlog::warn("{}", warning);
  const TimeStatistics scan = scan_statistics(summary);
  std::cout << fmt::format("{} of {} scans, {:.1f} m, {:.1f} ms a scan (p99 {:.1f}), {:.0f} MiB\n",
                           summary.processed, summary.scans, summary.path_m, scan.mean_ms, scan.p99_ms,
                           peak_memory_mib());
  std::cout << fmt::format("objects: {}\n", objects_text(summary));
  if (summary.skipped > 0) std::cout << fmt::format("skipped: {} scans\n", summary.skipped);
  if (summary.predicted > 0) {
    std::cout << fmt::format("lost: {} scans have a predicted pose only\n", summary.predicted);
  }
  if (summary.degenerate + summary.odometry_degenerate > 0) {
    std::cout << fmt::format(
        "degenerate: {} scans did not constrain every direction for the odometry, {} for the map "
        "refinement\n",
        summary.odometry_degenerate, summary.degenerate);
  }
  if (summary.loops > 0) std::cout << fmt::format("loops closed: {}\n", summary.loops);
  std::cout << fmt::format("results in {}: trajectory.txt, static_map.ply, run.json, per_scan.csv\n",
                           out.string());
}

void run_command(Options options) {
  parse_frames(options.frames, options.run);
  const Dataset dataset = open(options);
  const PipelineConfig config = configure(options, dataset.sensor);
  std::optional<DetectionList> detections;
  if (!options.detections.empty()) {
    detections = read_detections(options.detections, dataset.calibration, {.sequence = dataset.sequence});
  }
  if (!options.map.empty()) {
    std::optional<Eigen::Vector4d> start;
    if (!options.start.empty()) start.emplace(options.start.data());
    options.run.map = start_in_map(options.map, start);
  }
  std::optional<tbb::global_control> limit;
  if (options.threads > 0) {
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options.threads));
  }
  std::signal(SIGINT, [](int) { stop_requested = true; });
  std::signal(SIGTERM, [](int) { stop_requested = true; });
  std::optional<Progress> progress;
  const auto on_scan = [&](std::size_t done, std::size_t total) {
    if (!progress) progress.emplace("scans", total);
    progress->update(done);
  };
  const RunSummary summary =
      run(dataset, detections, config, options.run, on_scan, [] { return stop_requested.load(); });
  progress.reset();
  print_summary(summary, options.run.out);
  if (summary.interrupted) {
    spdlog::warn("stopped early: the results hold the scans up to then; --resume goes on from there");
    throw CLI::RuntimeError(kInterrupted);
  }
}

void add_object_options(CLI::App& command, Options& options) {
  command
      .add_option("--detections", options.detections,
                  "3D boxes: AB3DMOT CSV, KITTI labels or results, JSON or CSV of our own; file or folder")
      ->type_name("PATH");
  command
      .add_option("--detector", options.detector,
                  "Finds objects where no boxes are given, short for --set detection.detector=...")
      ->check(CLI::IsMember({"none", "cluster", "3dssd"}))
      ->excludes("--detections");
}

void add_map_options(CLI::App& command, Options& options) {
  auto* map = command.add_option("--map", options.map,
                                 "Localise in the map of an earlier run (scene.mlo, .ply, .pcd); make none");
  map->type_name("FILE");
  command
      .add_option("--start", options.start,
                  "Where in that map, within 5 m and 15 degrees [m, m, m, deg]; default: where its run began")
      ->delimiter(',')
      ->expected(4)
      ->type_name("X,Y,Z,YAW")
      ->needs(map);
}

void add_resume_options(CLI::App& command, RunOptions& options) {
  command.add_flag("--resume", options.resume,
                   "Go on where a run with the same DIR, scans and settings was stopped or killed");
  command
      .add_option("--save-every", options.state_scans,
                  "Scans between the states that --resume goes on from, at first; 0: none")
      ->capture_default_str();
}

}  // namespace

void add_run(CLI::App& program) {
  auto* command = program.add_subcommand("run", "From scans to a trajectory and a static map");
  const auto options = std::make_shared<Options>();
  command->add_option("folder", options->folder, "KITTI odometry, raw or tracking data, or a folder of scans")
      ->required()
      ->type_name("FOLDER");
  command->add_option("--out", options->run.out, "Folder for the results; made if missing")
      ->required()
      ->type_name("DIR");
  command->add_option("--sequence", options->open.sequence, "Which one, where the folder holds several")
      ->type_name("N");
  command->add_option("--format", options->open.format, "Layout of the folder; found out by default")
      ->check(CLI::IsMember({"auto", "kitti_odometry", "kitti_raw", "kitti_tracking", "folder"}));
  add_object_options(*command, *options);
  command->add_option("--frames", options->frames, "Only these frames, ends included: 0:99, 50:, :99")
      ->type_name("A:B");
  command->add_option("--roi", options->roi, "Region of interest, short for --set input.roi=...")
      ->check(CLI::IsMember({"full", "camera"}));
  add_map_options(*command, *options);
  add_resume_options(*command, options->run);
  command
      ->add_option("--threads", options->threads,
                   "Most threads to use, 0 for all cores; the results are the same")
      ->check(CLI::NonNegativeNumber);
  add_config_options(*command, options->config);
  command->footer(R"(
Writes to DIR: trajectory.txt (KITTI rows, lidar poses in the first scan's frame), trajectory_camera.txt
(the same for KITTI's camera 0), trajectory_tum.txt, odometry.txt (before map refinement), static_map.ply
and .pcd, scene.mlo (all of it over time, see 'mlo scene'), unknown_movers.csv (what moves without a box), run.json,
per_scan.csv and config.yaml; unless --detector is none also objects.csv (pose, velocity, size of each tracked
object in each scan), object_trajectories/ID.txt (TUM rows) and object_maps/ID.ply (in its own frame).

Examples:
  mlo run kitti/sequences/04 --out out/04
  mlo run kitti --sequence 04 --roi camera --preset paper --out out/04_paper
  mlo run kitti_raw/2011_09_26/2011_09_26_drive_0005_sync --out out/0005
  mlo run kitti_raw/2011_09_26/2011_09_26_drive_0005_sync --detections boxes.csv --out out/0005
  mlo run my_scans --preset vlp16 --frames 0:499 --out out/mine
  mlo run my_scans --preset vlp16 --frames 0:499 --out out/mine --resume
  mlo run second_visit --map out/mine/scene.mlo --start 12.5,-3,0,90 --out out/second)");
  command->callback([options] { run_command(*options); });
}

}  // namespace mlo::apps
