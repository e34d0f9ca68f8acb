#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/mlo/eval.hpp"
#include "mlo/core/error.hpp"
#include "mlo/evaluation/plot.hpp"
#include "mlo/evaluation/trajectory_error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/calibration.hpp"
#include "mlo/io/pose_files.hpp"
#include "mlo/io/trajectory_file.hpp"

namespace mlo::apps {
namespace {

constexpr const char* kExamples =
    R"(Units: ATE [m] is the RMSE of positions after rigid alignment; RTE [m/frame] and RRE [deg/frame] are mean errors
of the motion between consecutive frames; end [m] is the distance of the last positions when the first poses coincide;
the KITTI metric [%] and [deg/m] is the mean error over sub-paths of the lengths given.

Examples:
  mlo eval trajectory --truth truth_lidar/01.txt --estimate out/trajectory.txt
  mlo eval trajectory --truth poses/01.txt --calib sequences/01/calib.txt --estimate out/trajectory.txt
  mlo eval trajectory --truth 2011_09_26/2011_09_26_drive_0005_sync/oxts --calib 2011_09_26 --estimate out/trajectory.txt
  mlo eval trajectory --truth truth.tum --estimate a.tum b.tum --match time --plot errors.svg
  mlo eval trajectory --truth poses/00.txt --estimate out/trajectory_camera.txt --plane xz --json > errors.json
)";

struct Options {
  std::filesystem::path truth;
  std::filesystem::path calibration;
  std::vector<std::filesystem::path> estimates;
  std::string match = "auto";
  double max_time_difference_s = 0.02;
  std::vector<double> segment_lengths_m = TrajectoryErrorOptions{}.segment_lengths_m;
  std::string plane = "xy";
  std::filesystem::path plot;
  bool json = false;
};

struct Evaluation {
  std::string name;
  PoseMatching matching;
  TrajectoryErrors errors;
};

TrajectoryView view(const PoseList& poses) {
  return {poses.frames, poses.stamps_s, poses.T_world_body};
}

// Poses of the lidar where a calibration is given; else of the body that the file is about.
PoseList read_truth(const Options& options) {
  const bool is_oxts = std::filesystem::is_directory(options.truth);
  PoseList poses = is_oxts ? read_oxts_folder(options.truth) : read_trajectory(options.truth);
  if (options.calibration.empty()) return poses;
  const Calibration calibration = std::filesystem::is_directory(options.calibration)
                                      ? read_raw_calibration(options.calibration)
                                      : read_calibration_file(options.calibration);
  const std::optional<SE3>& T_body_lidar = is_oxts ? calibration.T_imu_lidar : calibration.T_camera0_lidar;
  if (!T_body_lidar) {
    throw InputError(
        fmt::format("{}: does not hold the lidar's place relative to the {}; give the calibration that "
                    "belongs to the truth",
                    options.calibration.string(), is_oxts ? "IMU" : "camera"));
  }
  return rebased(std::move(poses), *T_body_lidar);
}

MatchBy choose_matching(const std::string& match, const PoseList& truth, const PoseList& estimate) {
  if (match == "frame") return MatchBy::frame;
  const bool both_have_stamps = !truth.stamps_s.empty() && !estimate.stamps_s.empty();
  if (match == "time" && !both_have_stamps) {
    throw InputError("--match time needs stamps in truth and estimate (TUM files); KITTI rows have none");
  }
  return both_have_stamps ? MatchBy::time : MatchBy::frame;
}

Evaluation evaluate(const PoseList& truth, const std::filesystem::path& path, const Options& options) {
  const PoseList estimate = read_trajectory(path);
  const MatchBy by = choose_matching(options.match, truth, estimate);
  Evaluation evaluation{
      .name = path.string(),
      .matching = match_poses(view(truth), view(estimate), by, options.max_time_difference_s),
      .errors = {}};
  evaluation.errors =
      trajectory_errors(evaluation.matching, {.segment_lengths_m = options.segment_lengths_m});
  return evaluation;
}

std::string_view name_of(MatchBy by) {
  return by == MatchBy::frame ? "frame" : "time";
}

std::string cell(const std::optional<double>& value, const char* format = "{:.4f}") {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}

void print_bins(const Evaluation& evaluation) {
  const auto print = [](const char* label, const char* unit, const std::vector<SegmentBin>& bins) {
    for (const SegmentBin& bin : bins) {
      if (bin.errors.count == 0) continue;
      fmt::print("  {} {:>5g} {:<4} {:>6} sub-paths {:>9.4f} % {:>10.6f} deg/m\n", label, bin.value, unit,
                 bin.errors.count, bin.errors.translation_percent, bin.errors.rotation_deg_per_m);
    }
  };
  if (evaluation.errors.segments.count == 0) return;
  fmt::print("\n{}\n", evaluation.name);
  print("length", "m", evaluation.errors.by_length);
  print("speed ", "m/s", evaluation.errors.by_speed);
}

void print_table(const PoseList& truth, const std::vector<Evaluation>& evaluations, const Options& options) {
  std::size_t width = 8;
  for (const Evaluation& evaluation : evaluations) width = std::max(width, evaluation.name.size());
  fmt::print("truth: {} ({} poses)\n", options.truth.string(), truth.T_world_body.size());
  for (const Evaluation& e : evaluations) {
    fmt::print("{}: matched by {}, {} pairs; without a partner: {} of the truth, {} of the estimate\n",
               e.name, name_of(e.matching.by), e.matching.pairs.size(), e.matching.unmatched_truth,
               e.matching.unmatched_estimate);
  }
  fmt::print("\n{:<{}} {:>9} {:>9} {:>12} {:>14} {:>8} {:>8} {:>10}\n", "estimate", width, "path [m]",
             "ATE [m]", "RTE [m/frame]", "RRE [deg/frame]", "end [m]", "KITTI %", "deg/m");
  for (const Evaluation& evaluation : evaluations) {
    const TrajectoryErrors& errors = evaluation.errors;
    const bool has_segments = errors.segments.count > 0;
    fmt::print("{:<{}} {:>9.2f} {:>9} {:>13} {:>15} {:>8} {:>8} {:>10}\n", evaluation.name, width,
               errors.estimate_path_m, cell(errors.ate_m), cell(errors.rte_m_per_frame),
               cell(errors.rre_deg_per_frame), cell(errors.end_point_error_m, "{:.3f}"),
               has_segments ? fmt::format("{:.4f}", errors.segments.translation_percent) : "-",
               has_segments ? fmt::format("{:.6f}", errors.segments.rotation_deg_per_m) : "-");
  }
  for (const Evaluation& evaluation : evaluations) print_bins(evaluation);
}

nlohmann::ordered_json json_of(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json json_of(const SegmentErrors& errors) {
  if (errors.count == 0)
    return {{"count", 0}, {"translation_percent", nullptr}, {"rotation_deg_per_m", nullptr}};
  return {{"count", errors.count},
          {"translation_percent", errors.translation_percent},
          {"rotation_deg_per_m", errors.rotation_deg_per_m}};
}

nlohmann::ordered_json json_of(const std::vector<SegmentBin>& bins, const char* key) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const SegmentBin& bin : bins) {
    nlohmann::ordered_json row = {{key, bin.value}};
    row.update(json_of(bin.errors));
    rows.push_back(std::move(row));
  }
  return rows;
}

nlohmann::ordered_json json_of(const Evaluation& evaluation) {
  const TrajectoryErrors& errors = evaluation.errors;
  nlohmann::ordered_json frames = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < evaluation.matching.pairs.size(); ++i) {
    nlohmann::ordered_json row = {{"frame", evaluation.matching.pairs[i].frame},
                                  {"position_error_m", errors.position_errors_m[i]}};
    if (i > 0) {
      row["step_translation_error_m"] = errors.steps[i - 1].translation_m;
      row["step_rotation_error_deg"] = errors.steps[i - 1].rotation_deg;
    }
    frames.push_back(std::move(row));
  }
  return {{"estimate", evaluation.name},
          {"matched_by", name_of(evaluation.matching.by)},
          {"pairs", errors.num_pairs},
          {"unmatched_truth", evaluation.matching.unmatched_truth},
          {"unmatched_estimate", evaluation.matching.unmatched_estimate},
          {"truth_path_m", errors.truth_path_m},
          {"estimate_path_m", errors.estimate_path_m},
          {"ate_m", json_of(errors.ate_m)},
          {"rte_m_per_frame", json_of(errors.rte_m_per_frame)},
          {"rre_deg_per_frame", json_of(errors.rre_deg_per_frame)},
          {"end_point_error_m", json_of(errors.end_point_error_m)},
          {"kitti", json_of(errors.segments)},
          {"kitti_by_length", json_of(errors.by_length, "length_m")},
          {"kitti_by_speed", json_of(errors.by_speed, "speed_m_per_s")},
          {"frames", std::move(frames)}};
}

std::vector<PlotPanel> plot_panels(const std::vector<Evaluation>& evaluations, const std::string& plane) {
  const bool camera = plane == "xz";
  const auto project = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector2d(p.x(), camera ? p.z() : p.y());
  };
  std::vector<PlotPanel> panels{
      {"Path seen from above, aligned", "x [m]", camera ? "z [m]" : "y [m]", true, {}},
      {"Position error after alignment", "frame", "[m]", false, {}},
      {"Translation error of each step (RTE)", "frame", "[m/frame]", false, {}},
      {"Rotation error of each step (RRE)", "frame", "[deg/frame]", false, {}}};
  for (std::size_t k = 0; k < evaluations.size(); ++k) {
    const auto& [name, matching, errors] = evaluations[k];
    if (k == 0) {
      PlotCurve truth{"truth", 0, {}};
      for (const PosePair& pair : matching.pairs)
        truth.points.push_back(project(pair.T_world_truth.translation()));
      panels[0].curves.push_back(std::move(truth));
    }
    std::vector<PlotCurve> curves(panels.size(), {name, k + 1, {}});
    for (std::size_t i = 0; i < matching.pairs.size(); ++i) {
      const PosePair& pair = matching.pairs[i];
      const auto frame = static_cast<double>(pair.frame);
      curves[0].points.push_back(project(errors.T_truth_estimate * pair.T_world_estimate.translation()));
      curves[1].points.emplace_back(frame, errors.position_errors_m[i]);
      if (i == 0) continue;
      curves[2].points.emplace_back(frame, errors.steps[i - 1].translation_m);
      curves[3].points.emplace_back(frame, errors.steps[i - 1].rotation_deg);
    }
    for (std::size_t i = 0; i < panels.size(); ++i) panels[i].curves.push_back(std::move(curves[i]));
  }
  return panels;
}

void run(const Options& options) {
  const PoseList truth = read_truth(options);
  std::vector<Evaluation> evaluations;
  for (const std::filesystem::path& path : options.estimates)
    evaluations.push_back(evaluate(truth, path, options));
  if (!options.plot.empty())
    write_file_atomically(options.plot, svg_plot(plot_panels(evaluations, options.plane)));
  if (!options.json) return print_table(truth, evaluations, options);
  nlohmann::ordered_json json = {{"truth", options.truth.string()},
                                 {"estimates", nlohmann::ordered_json::array()}};
  for (const Evaluation& evaluation : evaluations) json["estimates"].push_back(json_of(evaluation));
  fmt::print("{}\n", json.dump(2));
}

}  // namespace

void add_eval_trajectory(CLI::App& eval) {
  CLI::App* command =
      eval.add_subcommand("trajectory", "Errors of trajectories (ATE, RTE, RRE, KITTI metric)");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("--truth", options->truth,
                   "true poses: KITTI rows (12 numbers), TUM rows (8), or a KITTI raw oxts folder")
      ->required();
  command->add_option(
      "--calib", options->calibration,
      "brings the truth to the lidar: calib.txt of KITTI odometry or tracking for camera poses, the "
      "folder of the date for oxts");
  command->add_option("--estimate", options->estimates, "one or more files of poses of the same body")
      ->required();
  command
      ->add_option("--match", options->match,
                   "pair poses by row number or by stamp; auto: by stamp if both have them")
      ->check(CLI::IsMember({"auto", "frame", "time"}))
      ->capture_default_str();
  command
      ->add_option("--max-time-difference", options->max_time_difference_s,
                   "largest difference of paired stamps [s]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--lengths", options->segment_lengths_m, "sub-path lengths of the KITTI metric [m]")
      ->check(CLI::PositiveNumber)
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--plane", options->plane,
                   "what the plot shows as ground: xy (lidar) or xz (camera frames)")
      ->check(CLI::IsMember({"xy", "xz"}))
      ->capture_default_str();
  command->add_option("--plot", options->plot, "write path and errors to this SVG file");
  command->add_flag("--json", options->json, "print JSON, with the errors of every frame, not a table");
  command->footer(kExamples);
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
