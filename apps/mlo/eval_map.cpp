#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "apps/mlo/eval.hpp"
#include "mlo/core/error.hpp"
#include "mlo/evaluation/map_quality.hpp"
#include "mlo/evaluation/map_removal.hpp"
#include "mlo/io/labelled_points.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/truth/labelled_map.hpp"

namespace mlo::apps {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::vector<std::filesystem::path> clouds;
  MapQualityOptions quality;
  std::filesystem::path truth;
  std::filesystem::path poses;
  OpenOptions open;
  double truth_voxel_m = 0.05;
  bool without_movable = false;
  MapRemovalOptions removal;
  bool json = false;
};

struct Judgement {
  std::string name;
  MapQuality quality;
  std::optional<MapRemoval> removal;  ///< only with truth
};

PoseList poses_of_scans(const Dataset& dataset, const Options& options) {
  if (!options.poses.empty()) return read_trajectory(options.poses);
  if (!dataset.truth) {
    throw InputError(
        fmt::format("{}: has no true poses; give the poses of the run with --poses", options.truth.string()));
  }
  return *dataset.truth;
}

Movable movable(const Options& options) {
  return options.without_movable ? Movable::is_left_out : Movable::counts_as_at_rest;
}

std::vector<LabelledPoint> labels_of_scans(const Options& options) {
  const Dataset dataset = open_dataset(options.truth, options.open);
  const auto labels = find_point_labels(dataset);
  if (!labels) {
    throw InputError(fmt::format("{}: has scans, but no folder labels with a .label file for each of them",
                                 options.truth.string()));
  }
  LabelledMap map = build_labelled_map(dataset, *labels, poses_of_scans(dataset, options),
                                       options.truth_voxel_m, movable(options));
  for (const std::string& problem : map.problems) spdlog::warn("left out: {}", problem);
  if (map.scans == 0)
    throw InputError(fmt::format("{}: no scan has both labels and a pose", options.truth.string()));
  return std::move(map.points);
}

std::optional<std::vector<LabelledPoint>> read_labels(const Options& options) {
  if (options.truth.empty()) return std::nullopt;
  if (is_directory(options.truth)) return labels_of_scans(options);
  return read_labelled_cloud(options.truth, movable(options));
}

Judgement judge(const std::filesystem::path& cloud, const std::optional<std::vector<LabelledPoint>>& truth,
                const Options& options) {
  std::vector<Eigen::Vector3f> points;
  for (const MapPoint& point : read_map(cloud)) points.push_back(point.p_map);
  Judgement judgement{cloud.string(), map_quality(points, options.quality), std::nullopt};
  if (truth) judgement.removal = map_removal(*truth, points, options.removal);
  return judgement;
}

ordered_json to_json(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json to_json(const Judgement& judgement) {
  const MapQuality& quality = judgement.quality;
  ordered_json json{{"cloud", judgement.name},
                    {"points", quality.num_points},
                    {"samples", quality.num_samples},
                    {"planar", quality.num_planar},
                    {"plane_residual_mean_m", to_json(quality.plane_residual_mean_m)},
                    {"plane_residual_median_m", to_json(quality.plane_residual_median_m)},
                    {"mean_entropy", to_json(quality.mean_entropy)}};
  if (!judgement.removal) return json;
  const MapRemoval& removal = *judgement.removal;
  json["removal"] = {{"static_voxels", removal.static_voxels},
                     {"static_voxels_kept", removal.static_voxels_kept},
                     {"dynamic_voxels", removal.dynamic_voxels},
                     {"dynamic_voxels_kept", removal.dynamic_voxels_kept},
                     {"preservation_rate", to_json(removal.preservation_rate())},
                     {"rejection_rate", to_json(removal.rejection_rate())},
                     {"f1", to_json(removal.f1())},
                     {"static_points", removal.static_points},
                     {"static_points_kept", removal.static_points_kept},
                     {"dynamic_points", removal.dynamic_points},
                     {"dynamic_points_kept", removal.dynamic_points_kept},
                     {"static_accuracy", to_json(removal.static_accuracy())},
                     {"dynamic_accuracy", to_json(removal.dynamic_accuracy())},
                     {"associated_accuracy", to_json(removal.associated_accuracy())}};
  return json;
}

std::string cell(const std::optional<double>& value, double scale) {
  return value ? fmt::format("{:.2f}", *value * scale) : "-";
}

void print_quality(const std::vector<Judgement>& judgements) {
  std::cout << fmt::format("{:>10} {:>9} {:>9} {:>12} {:>14} {:>9}  {}\n", "points", "samples", "planar",
                           "mean [mm]", "median [mm]", "entropy", "cloud");
  for (const auto& [name, quality, removal] : judgements) {
    std::cout << fmt::format(
        "{:>10} {:>9} {:>9} {:>12} {:>14} {:>9}  {}\n", quality.num_points, quality.num_samples,
        quality.num_planar, cell(quality.plane_residual_mean_m, 1000.0),
        cell(quality.plane_residual_median_m, 1000.0), cell(quality.mean_entropy, 1.0), name);
  }
}

void print_removal(const std::vector<Judgement>& judgements, const MapRemovalOptions& options) {
  std::cout << fmt::format(
      "\nPR, RR, F1 [%] over voxels of {:g} m (ERASOR); SA, DA, AA [%] over points, in the map within {:g} m "
      "(DynamicMap_Benchmark)\n{:>9} {:>9} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7}  {}\n",
      options.voxel_m, options.distance_m, "static", "dynamic", "PR", "RR", "F1", "SA", "DA", "AA", "cloud");
  for (const auto& [name, quality, removal] : judgements) {
    if (!removal) continue;
    std::cout << fmt::format("{:>9} {:>9} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7}  {}\n", removal->static_voxels,
                             removal->dynamic_voxels, cell(removal->preservation_rate(), 100.0),
                             cell(removal->rejection_rate(), 100.0), cell(removal->f1(), 100.0),
                             cell(removal->static_accuracy(), 100.0),
                             cell(removal->dynamic_accuracy(), 100.0),
                             cell(removal->associated_accuracy(), 100.0), name);
  }
}

void run(const Options& options) {
  const auto truth = read_labels(options);
  std::vector<Judgement> judgements;
  for (const std::filesystem::path& cloud : options.clouds)
    judgements.push_back(judge(cloud, truth, options));
  if (options.json) {
    ordered_json report = ordered_json::array();
    for (const Judgement& judgement : judgements) report.push_back(to_json(judgement));
    std::cout << report.dump(2) << "\n";
    return;
  }
  print_quality(judgements);
  if (truth) print_removal(judgements, options.removal);
}

void add_truth_options(CLI::App& command, Options& options) {
  auto* truth = command
                    .add_option("--truth", options.truth,
                                "Labelled points: a PLY or PCD file, or a folder of scans with labels "
                                "(SemanticKITTI's layout, or one of 'mlo simulate')")
                    ->type_name("PATH");
  command
      .add_option("--poses", options.poses,
                  "Places the labelled scans: those of the run that made the map, to judge what it removed "
                  "apart from where it drifted (default: the true poses)")
      ->type_name("FILE")
      ->needs(truth);
  command.add_option("--sequence", options.open.sequence, "Which one, where --truth holds several")
      ->type_name("N")
      ->needs(truth);
  const auto positive = [&](const char* name, double& value, const char* meaning) {
    command.add_option(name, value, meaning)->check(CLI::PositiveNumber)->capture_default_str();
  };
  positive("--voxel", options.removal.voxel_m, "Side of the voxels of PR and RR [m]");
  positive("--distance", options.removal.distance_m,
           "A labelled point this near to the map is in it (SA, DA): half the map's voxels [m]");
  positive("--truth-voxel", options.truth_voxel_m, "Spacing of the labelled points made of scans [m]");
  command.add_flag(
      "--without-movable", options.without_movable,
      "Do not count vehicles and people at rest (SemanticKITTI's classes 10 to 32), which the maps "
      "of mlo run are meant to be without");
}

}  // namespace

void add_eval_map(CLI::App& eval) {
  auto* command =
      eval.add_subcommand("map", "Maps: sharpness, and against labels, what they keep and what they remove");
  const auto options = std::make_shared<Options>();
  command->add_option("--cloud", options->clouds, "Maps to compare: PLY or PCD")
      ->required()
      ->type_name("FILE");
  command->add_option("--radius", options->quality.radius_m, "Of a neighbourhood, for the sharpness [m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  add_truth_options(*command, *options);
  command->add_flag("--json", options->json, "JSON instead of a table; shares, not per cent");
  command->footer(R"(
Sharpness (thickness of planes, entropy) needs no truth; lower is better, for maps of the same scans made with the same
settings. With --truth: preservation rate, rejection rate and F1 (ERASOR) and static, dynamic and associated
accuracy (DynamicMap_Benchmark); see docs/evaluation.md.

Examples:
  mlo eval map --cloud out/a/static_map.ply --cloud out/b/static_map.ply
  mlo eval map --cloud out/static_map.ply --truth city --poses out/trajectory.txt
  mlo eval map --cloud cleaned.pcd --truth gt_cloud.pcd --distance 0.05)");
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
