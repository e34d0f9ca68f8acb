#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/mlo/commands.hpp"
#include "mlo/io/dataset.hpp"
#include "mlo/io/dataset_report.hpp"

namespace mlo::apps {
namespace {

constexpr std::size_t kSampleSize = 100;

constexpr const char* kExamples = R"(
Recognised: KITTI odometry, raw and tracking at any level of their folders, and plain folders of .bin, .pcd
and .ply files.
Reads 100 scans, evenly spread, unless --all is given.

Examples:
  mlo info kitti_odometry --sequence 04
  mlo info 2011_09_26/2011_09_26_drive_0005_sync --all
  mlo info kitti_tracking --sequence 0000 --detections detections/pointrcnn_car
  mlo info scans --format folder --json > scans.json)";

struct Options {
  std::filesystem::path folder;
  OpenOptions open;
  std::vector<std::filesystem::path> detections;
  bool all = false;
  bool json = false;
};

std::vector<std::string> calibrations(const Dataset& dataset) {
  std::vector<std::string> names;
  if (dataset.calibration.T_camera0_lidar) names.emplace_back("camera");
  if (dataset.calibration.P2) names.emplace_back("image");
  if (dataset.calibration.T_imu_lidar) names.emplace_back("imu");
  return names;
}

// What the user names, else the labels that come along.
std::optional<DetectionReport> detections_of(const Dataset& dataset, const Options& options) {
  std::vector<std::filesystem::path> paths = options.detections;
  if (paths.empty() && !dataset.labels.empty()) paths.push_back(dataset.labels);
  if (paths.empty()) return std::nullopt;
  const DetectionList list = read_detections(paths, dataset.calibration, {.sequence = dataset.sequence});
  return report_on_detections(dataset, list);
}

std::string detection_text(const DetectionReport& report) {
  std::string classes;
  for (const auto& [name, count] : report.by_class) classes += fmt::format(", {} {}", count, name);
  return fmt::format("{} in {} scans{}; {} of {} boxes looked at hold points", report.boxes, report.scans,
                     classes, report.check.boxes_with_points, report.check.boxes);
}

void print_text(const Dataset& dataset, const DatasetReport& report,
                const std::optional<DetectionReport>& detections) {
  const auto row = [](const char* name, const std::string& text) { fmt::print("{:<14}{}\n", name, text); };
  const auto spread = [](const Spread& s, const char* format) {
    return fmt::format(fmt::runtime(fmt::format("{0} ... {0} ... {0}", format)), s.min, s.median, s.max);
  };
  row("format", dataset.format + (dataset.sequence.empty() ? "" : ", sequence " + dataset.sequence));
  row("folder", dataset.root.string());
  row("scans", fmt::format("{} (frames {} to {}), {} read: {} missing, {} unreadable", report.scans,
                           report.first_frame, report.last_frame, report.scans_read, report.scans_missing,
                           report.scans_unreadable));
  row("time", fmt::format("{:.3f} s, {:.3f} scans/s, {} gaps", report.duration_s, report.rate_hz,
                          report.gaps.size()));
  for (const StampGap& gap : report.gaps)
    row("", fmt::format("{:.3f} s after frame {}", gap.length_s, gap.frame));
  row("sensor", fmt::format("{}, {}", dataset.sensor.name,
                            report.motion_compensated ? "motion-compensated" : "not motion-compensated"));
  row("points", fmt::format("{} per scan (min ... median ... max), {} invalid left out",
                            spread(report.points, "{:.0f}"), report.invalid_points));
  row("scan lines", spread(report.rings, "{:.0f}"));
  row("range", spread(report.range_m, "{:.2f}") + " m");
  row("sweep", spread(report.sweep_fraction, "{:.3f}") + " of a revolution");
  row("calibration", dataset.calibration.T_camera0_lidar || dataset.calibration.T_imu_lidar
                         ? fmt::format("{}", fmt::join(calibrations(dataset), ", "))
                         : "none");
  row("truth", report.poses > 0 ? fmt::format("{} poses, {:.1f} m", report.poses, report.path_m) : "none");
  row("labels", dataset.labels.empty() ? "none" : dataset.labels.string());
  row("detections", detections ? detection_text(*detections) : "none");
  row("looks wrong", report.findings.empty() ? "nothing" : "");
  for (const std::string& finding : report.findings) fmt::print("  - {}\n", finding);
}

nlohmann::ordered_json json_of(const std::optional<DetectionReport>& detections) {
  if (!detections) return nullptr;
  return {{"boxes", detections->boxes},
          {"scans", detections->scans},
          {"by_class", detections->by_class},
          {"boxes_checked", detections->check.boxes},
          {"boxes_with_points", detections->check.boxes_with_points}};
}

void print_json(const Dataset& dataset, const DatasetReport& report,
                const std::optional<DetectionReport>& detections) {
  using Json = nlohmann::ordered_json;
  const auto spread = [](const Spread& s) {
    return Json{{"min", s.min}, {"median", s.median}, {"max", s.max}};
  };
  Json gaps = Json::array();
  for (const StampGap& gap : report.gaps) gaps.push_back({{"frame", gap.frame}, {"length_s", gap.length_s}});
  const Json json = {{"format", dataset.format},
                     {"sequence", dataset.sequence},
                     {"folder", dataset.root.string()},
                     {"scans", report.scans},
                     {"first_frame", report.first_frame},
                     {"last_frame", report.last_frame},
                     {"duration_s", report.duration_s},
                     {"rate_hz", report.rate_hz},
                     {"gaps", gaps},
                     {"scans_read", report.scans_read},
                     {"scans_missing", report.scans_missing},
                     {"scans_unreadable", report.scans_unreadable},
                     {"sensor", dataset.sensor.name},
                     {"motion_compensated", report.motion_compensated},
                     {"points", spread(report.points)},
                     {"invalid_points", report.invalid_points},
                     {"rings", spread(report.rings)},
                     {"range_m", spread(report.range_m)},
                     {"sweep_fraction", spread(report.sweep_fraction)},
                     {"calibration", calibrations(dataset)},
                     {"truth_poses", report.poses},
                     {"truth_path_m", report.path_m},
                     {"labels", dataset.labels.string()},
                     {"detections", json_of(detections)},
                     {"findings", report.findings}};
  fmt::print("{}\n", json.dump(2));
}

void run(const Options& options) {
  const Dataset dataset = open_dataset(options.folder, options.open);
  DatasetReport report = report_on(dataset, options.all ? 0 : kSampleSize);
  const std::optional<DetectionReport> detections = detections_of(dataset, options);
  if (detections && !detections->check.problem.empty()) report.findings.push_back(detections->check.problem);
  if (options.json) {
    print_json(dataset, report, detections);
  } else {
    print_text(dataset, report, detections);
  }
}

}  // namespace

void add_info(CLI::App& program) {
  auto* command =
      program.add_subcommand("info", "Say what a folder of scans holds, and what looks wrong in it");
  const auto options = std::make_shared<Options>();
  command->add_option("folder", options->folder, "Folder of scans")->required()->type_name("FOLDER");
  command->add_option("--format", options->open.format,
                      "auto, kitti_odometry, kitti_raw, kitti_tracking or folder (default auto)");
  command->add_option("--sequence", options->open.sequence,
                      "Which sequence, by name or number, if the folder holds several");
  command
      ->add_option("--detections", options->detections,
                   "Files or folders of detections to count and to check (default: labels that come along)")
      ->type_name("PATH");
  command->add_flag("--all", options->all, "Read every scan");
  command->add_flag("--json", options->json, "Print JSON");
  command->footer(kExamples);
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
