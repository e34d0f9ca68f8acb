#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/mlo/eval.hpp"
#include "mlo/core/error.hpp"
#include "mlo/evaluation/trajectory_plots.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/io/true_poses.hpp"

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

using Evaluation = TrajectoryEvaluation;

TrajectoryView view(const PoseList& poses) {
  return {poses.frames, poses.stamps_s, poses.T_world_body};
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

void run(const Options& options) {
  const PoseList truth = read_true_poses(options.truth, options.calibration);
  std::vector<Evaluation> evaluations;
  for (const std::filesystem::path& path : options.estimates)
    evaluations.push_back(evaluate(truth, path, options));
  if (!options.plot.empty())
    write_file_atomically(
        options.plot,
        svg_plot(trajectory_panels(evaluations, options.plane == "xz" ? GroundPlane::xz : GroundPlane::xy)));
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
