#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/mlo/commands.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/scene/scene_export.hpp"

namespace mlo::apps {
namespace {

constexpr const char* kExplanation = R"(
ply, pcd    the static map: x y z intensity label
kitti       the robot's trajectory, a KITTI row for each frame
tum         the robot's trajectory, stamped
csv         the objects in all scans, as objects.csv
mcap        everything, for Foxglove: /tf, /pose, /trajectory, /points, /objects, /map,
            /object_clouds (one message for each object, in its own frame: show them with an infinite decay time)

With --object: ply and pcd give what was seen of that object, in its own frame; kitti and tum its trajectory.

Examples:
  mlo export out/0005/scene.mlo --format mcap --out 0005.mcap
  mlo export out/0005/scene.mlo --format ply --out map.ply
  mlo export out/0005/scene.mlo --format tum --object 12 --out object_12.txt)";

struct Options {
  std::filesystem::path file;
  std::string format;
  std::filesystem::path out;
  std::optional<long> object;
  double voxel_m = 0.05;
};

std::vector<MapPoint> points_of(const SceneFile& scene, const Options& options) {
  return options.object ? object_cloud(scene, *options.object, options.voxel_m) : scene.map();
}

PoseList poses_of(const SceneFile& scene, const Options& options) {
  return options.object ? object_trajectory(scene, *options.object) : robot_poses(scene);
}

using Exporter = std::function<void(const SceneFile&, const Options&)>;

std::map<std::string, Exporter> exporters() {
  return {{"ply",
           [](const auto& scene, const auto& options) { write_ply(options.out, points_of(scene, options)); }},
          {"pcd",
           [](const auto& scene, const auto& options) { write_pcd(options.out, points_of(scene, options)); }},
          {"kitti", [](const auto& scene,
                       const auto& options) { write_kitti_poses(options.out, poses_of(scene, options)); }},
          {"tum", [](const auto& scene,
                     const auto& options) { write_tum_poses(options.out, poses_of(scene, options)); }},
          {"csv", [](const auto& scene,
                     const auto& options) { write_objects_csv(options.out, object_poses(scene)); }},
          {"mcap", [](const auto& scene, const auto& options) { export_mcap(scene, options.out); }}};
}

void run(const Options& options) {
  if (options.object && (options.format == "csv" || options.format == "mcap")) {
    throw CLI::ValidationError("--object", fmt::format("{} holds all objects; leave it out", options.format));
  }
  exporters().at(options.format)(SceneFile(options.file), options);
  std::cout << fmt::format("{}: {:.2f} MB\n", options.out.string(),
                           1e-6 * static_cast<double>(std::filesystem::file_size(options.out)));
}

}  // namespace

void add_export(CLI::App& program) {
  auto* command = program.add_subcommand("export", "A scene in formats that other programs read");
  const auto options = std::make_shared<Options>();
  std::vector<std::string> formats;
  for (const auto& [name, exporter] : exporters()) formats.push_back(name);
  command->add_option("file", options->file, "scene.mlo of a run")->required()->type_name("FILE");
  command->add_option("--format", options->format, "What to write")
      ->required()
      ->check(CLI::IsMember(formats));
  command->add_option("--out", options->out, "The file to write")->required()->type_name("PATH");
  command->add_option("--object", options->object, "Only this one, by its id")->type_name("ID");
  command->add_option("--voxel", options->voxel_m, "An object's cloud is thinned to one point per voxel [m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->footer(kExplanation);
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
