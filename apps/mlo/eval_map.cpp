#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/mlo/eval.hpp"
#include "mlo/evaluation/map_quality.hpp"
#include "mlo/io/point_cloud_file.hpp"

namespace mlo::apps {
namespace {

struct Options {
  std::vector<std::filesystem::path> clouds;
  MapQualityOptions quality;
  bool json = false;
};

MapQuality judge(const std::filesystem::path& cloud, const MapQualityOptions& options) {
  std::vector<Eigen::Vector3f> points;
  for (const MapPoint& point : read_map(cloud)) points.push_back(point.p_map);
  return map_quality(points, options);
}

nlohmann::ordered_json to_json(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

std::string cell(const std::optional<double>& value, double scale) {
  return value ? fmt::format("{:.2f}", *value * scale) : "-";
}

void run(const Options& options) {
  nlohmann::ordered_json report = nlohmann::ordered_json::array();
  if (!options.json) {
    std::cout << fmt::format("{:>10} {:>9} {:>9} {:>12} {:>14} {:>9}  {}\n", "points", "samples", "planar",
                             "mean [mm]", "median [mm]", "entropy", "cloud");
  }
  for (const std::filesystem::path& cloud : options.clouds) {
    const MapQuality quality = judge(cloud, options.quality);
    if (!options.json) {
      std::cout << fmt::format("{:>10} {:>9} {:>9} {:>12} {:>14} {:>9}  {}\n", quality.num_points,
                               quality.num_samples, quality.num_planar,
                               cell(quality.plane_residual_mean_m, 1000.0),
                               cell(quality.plane_residual_median_m, 1000.0), cell(quality.mean_entropy, 1.0),
                               cloud.string());
      continue;
    }
    report.push_back({{"cloud", cloud.string()},
                      {"points", quality.num_points},
                      {"samples", quality.num_samples},
                      {"planar", quality.num_planar},
                      {"plane_residual_mean_m", to_json(quality.plane_residual_mean_m)},
                      {"plane_residual_median_m", to_json(quality.plane_residual_median_m)},
                      {"mean_entropy", to_json(quality.mean_entropy)}});
  }
  if (options.json) std::cout << report.dump(2) << "\n";
}

}  // namespace

void add_eval_map(CLI::App& eval) {
  auto* command = eval.add_subcommand("map", "Sharpness of maps, without truth: thickness of planes, entropy");
  const auto options = std::make_shared<Options>();
  command->add_option("--cloud", options->clouds, "Maps to compare: PLY or PCD")->required()->type_name("FILE");
  command->add_option("--radius", options->quality.radius_m, "Of a neighbourhood [m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--json", options->json, "JSON instead of a table");
  command->footer(R"(
Lower is better, for maps of the same scans made with the same settings; see docs/evaluation.md.

Examples:
  mlo eval map --cloud out/a/static_map.ply --cloud out/b/static_map.ply)");
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
