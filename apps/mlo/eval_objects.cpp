#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/mlo/eval.hpp"
#include "mlo/core/error.hpp"
#include "mlo/evaluation/object_trajectories.hpp"
#include "mlo/io/calibration.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/truth/object_truth.hpp"

namespace mlo::apps {
namespace {

using nlohmann::ordered_json;

constexpr const char* kExplanation = R"(
Files are objects.csv (frame, id, class, x_m, y_m, z_m, qx, qy, qz, qw in the map frame; docs/evaluation.md), or KITTI
tracking labels and results with the poses of the lidar and the calibration. Every true object gets at most one track for
its whole life; objects without one (lost), frames under another track or none, and switches are counted.

Examples:
  mlo eval objects --truth city/truth/objects.csv --estimate out/objects.csv
  mlo eval objects --truth city/truth/objects.csv --estimate out/objects.csv --class car van --min-path 5
  mlo eval objects --truth label_02/0000.txt --truth-poses truth/0000.txt --calib calib/0000.txt --estimate out/objects.csv)";

struct Options {
  std::filesystem::path truth;
  std::filesystem::path truth_poses;
  std::filesystem::path estimate;
  std::filesystem::path estimate_poses;
  std::filesystem::path calibration;
  std::vector<std::string> classes;
  double min_path_m = 0.0;
  ObjectTrajectoryOptions trajectories;
  bool json = false;
};

std::vector<ObjectPose> read_objects(const std::filesystem::path& file, const std::filesystem::path& poses,
                                     const std::filesystem::path& calibration, const char* poses_option) {
  if (file.extension() != ".txt") return read_objects_csv(file);
  if (poses.empty() || calibration.empty()) {
    throw InputError(
        fmt::format("{}: KITTI's boxes are relative to the camera; give the lidar's poses with {} and the "
                    "calibration with --calib",
                    file.string(), poses_option));
  }
  const Calibration known = read_calibration_file(calibration);
  if (!known.T_camera0_lidar) {
    throw InputError(
        fmt::format("{}: does not hold the lidar's place relative to the camera", calibration.string()));
  }
  return objects_in_map(boxes_in_lidar(read_kitti_tracks(file), *known.T_camera0_lidar),
                        read_trajectory(poses));
}

ObjectEvaluation evaluate(const Options& options) {
  const auto truth = read_objects(options.truth, options.truth_poses, options.calibration, "--truth-poses");
  const auto tracks =
      read_objects(options.estimate, options.estimate_poses, options.calibration, "--estimate-poses");
  ObjectEvaluation evaluation = evaluate_objects(truth, tracks, options.trajectories);
  std::erase_if(evaluation.objects, [&](const ObjectErrors& object) {
    const bool other_class =
        !options.classes.empty() && std::ranges::find(options.classes, object.type) == options.classes.end();
    return other_class || object.truth_path_m < options.min_path_m;
  });
  return evaluation;
}

std::string cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f}", *value) : "-";
}

void print_table(const ObjectEvaluation& evaluation) {
  fmt::print("{:>6} {:<11} {:>6} {:>7} {:>8} {:>6} {:>7} {:>8} {:>9} {:>8} {:>9} {:>10} {:>11}\n", "object",
             "class", "track", "frames", "tracked", "other", "missed", "switches", "path [m]", "ATE [m]",
             "RMSE [m]", "RTE [m/m]", "RRE [deg/m]");
  for (const ObjectErrors& object : evaluation.objects) {
    fmt::print("{:>6} {:<11} {:>6} {:>7} {:>8} {:>6} {:>7} {:>8} {:>9.2f} {:>8} {:>9} {:>10} {:>11}\n",
               object.truth_id, object.type, object.track_id ? fmt::format("{}", *object.track_id) : "lost",
               object.truth_frames, object.tracked_frames, object.other_frames, object.missed_frames,
               object.switches, object.truth_path_m, cell(object.ate_m), cell(object.position_rmse_m),
               cell(object.rte_m_per_m), cell(object.rre_deg_per_m));
  }
  const ObjectSummary all = summarise(evaluation.objects);
  fmt::print("{:>6} {:<11} {:>6} {:>7} {:>8} {:>6} {:>7} {:>8} {:>9} {:>8} {:>9} {:>10} {:>11}\n", "mean", "",
             "", all.truth_frames, all.tracked_frames, all.other_frames, all.missed_frames, all.switches, "",
             cell(all.ate_m), cell(all.position_rmse_m), cell(all.rte_m_per_m), cell(all.rre_deg_per_m));
  fmt::print("\n{} objects: {} lost, {} with switches; {} tracks without an object\n", all.objects, all.lost,
             all.switched, evaluation.tracks_without_object.size());
}

ordered_json json_of(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

/// What ObjectErrors and ObjectSummary have in common.
template <class Errors>
ordered_json measures_json(const Errors& errors) {
  return {{"truth_frames", errors.truth_frames},
          {"tracked_frames", errors.tracked_frames},
          {"other_frames", errors.other_frames},
          {"missed_frames", errors.missed_frames},
          {"switches", errors.switches},
          {"ate_m", json_of(errors.ate_m)},
          {"position_rmse_m", json_of(errors.position_rmse_m)},
          {"rte_m_per_m", json_of(errors.rte_m_per_m)},
          {"rre_deg_per_m", json_of(errors.rre_deg_per_m)}};
}

ordered_json json_of(const ObjectEvaluation& evaluation) {
  ordered_json rows = ordered_json::array();
  for (const ObjectErrors& object : evaluation.objects) {
    ordered_json row{{"id", object.truth_id},
                     {"class", object.type},
                     {"track", object.track_id ? ordered_json(*object.track_id) : ordered_json(nullptr)},
                     {"path_m", object.truth_path_m}};
    row.update(measures_json(object));
    rows.push_back(std::move(row));
  }
  const ObjectSummary summary = summarise(evaluation.objects);
  ordered_json all{{"objects", summary.objects}, {"lost", summary.lost}, {"switched", summary.switched}};
  all.update(measures_json(summary));
  return {{"all", std::move(all)},
          {"tracks_without_object", evaluation.tracks_without_object},
          {"objects", std::move(rows)}};
}

void run(const Options& options) {
  const ObjectEvaluation evaluation = evaluate(options);
  if (options.json) {
    fmt::print("{}\n", json_of(evaluation).dump(2));
  } else {
    print_table(evaluation);
  }
}

}  // namespace

void add_eval_objects(CLI::App& eval) {
  CLI::App* command =
      eval.add_subcommand("objects", "Trajectories of single objects in the map frame (ATE, RTE, RRE)");
  const auto options = std::make_shared<Options>();
  command->add_option("--truth", options->truth, "objects.csv or KITTI tracking labels (.txt)")->required();
  command->add_option("--truth-poses", options->truth_poses,
                      "true poses of the lidar, for KITTI labels: KITTI or TUM rows");
  command->add_option("--estimate", options->estimate, "objects.csv or a KITTI tracking result (.txt)")
      ->required();
  command->add_option("--estimate-poses", options->estimate_poses,
                      "poses of the lidar that the tracks go with, for a KITTI result");
  command->add_option("--calib", options->calibration, "calibration of KITTI's labels and results");
  command->add_option("--class", options->classes, "only true objects of these classes (default: all)");
  command
      ->add_option("--min-path", options->min_path_m, "only true objects that travel at least this far [m]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--min-points", options->trajectories.min_points,
                   "true poses with fewer returns are not demanded, where the truth counts them")
      ->capture_default_str();
  command
      ->add_option("--max-distance", options->trajectories.max_distance_m,
                   "a track farther from the true object does not cover it [m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--subpath", options->trajectories.subpath_m, "length of the sub-paths of RTE and RRE [m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--json", options->json, "print JSON, not a table");
  command->footer(kExplanation);
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
