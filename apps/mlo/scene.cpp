#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/mlo/commands.hpp"
#include "mlo/core/heading.hpp"
#include "mlo/scene/scene_state.hpp"
#include "mlo/scene/scene_summary.hpp"

namespace mlo::apps {
namespace {

using nlohmann::ordered_json;

constexpr const char* kExplanation = R"(
Without --time: what the file holds. With --time: pose of the robot (between two scans interpolated) and the
objects around it at that moment, in the map frame. A time is a stamp as in trajectory_tum.txt. The file of a
run that was killed, or that still goes on, holds all scans that were finished.

Examples:
  mlo scene out/04/scene.mlo
  mlo scene out/0005/scene.mlo --time 47124.25
  mlo scene out/0005/scene.mlo --time 47124.25 --json > state.json)";

struct Options {
  std::filesystem::path file;
  std::optional<double> stamp_s;
  bool json = false;
};

double yaw_deg(const SE3& pose) {
  return yaw_of(pose) * 180.0 / std::numbers::pi;
}

void print_row(const char* name, const std::string& text) {
  fmt::print("{:<10}{}\n", name, text);
}

std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{:.2f} MB", 1e-6 * static_cast<double>(bytes));
}

std::string counted(const std::map<std::string, std::size_t>& counts) {
  std::string text;
  for (const auto& [name, count] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  return text.empty() ? "none" : text;
}

std::map<std::string, std::size_t> statuses(const SceneSummary& summary) {
  std::map<std::string, std::size_t> counts;
  for (std::size_t i = 0; i < kNumScanStatuses; ++i) {
    if (summary.by_status[i] > 0)
      counts[std::string(to_string(static_cast<ScanStatus>(i)))] = summary.by_status[i];
  }
  return counts;
}

void print_summary(const SceneFile& scene, const SceneSummary& summary) {
  print_row("input", fmt::format("{} ({} {}), by mlo {}", scene.meta().input, scene.meta().format,
                                 scene.meta().sequence, scene.meta().program_version));
  print_row("file",
            fmt::format("{}{}: scans {}, clouds {}, map {}", megabytes(scene.size()),
                        scene.complete() ? "" : ", not ended", megabytes(scene.stored_bytes(ChunkType::scan)),
                        megabytes(scene.stored_bytes(ChunkType::cloud)),
                        megabytes(scene.stored_bytes(ChunkType::map_tile))));
  print_row("scans", fmt::format("{}: {}", summary.scans, counted(statuses(summary))));
  print_row("time", fmt::format("{:.6f} s to {:.6f} s", summary.first_stamp_s, summary.last_stamp_s));
  print_row("path", fmt::format("{:.1f} m", summary.path_m));
  print_row("objects", fmt::format("{}; {} mostly moving", counted(summary.objects), summary.objects_moving));
  print_row("map", fmt::format("{} points", summary.map_points));
}

ordered_json to_json(const SceneFile& scene, const SceneSummary& summary) {
  return {{"file", scene.path().string()},
          {"complete", scene.complete()},
          {"program_version", scene.meta().program_version},
          {"input", scene.meta().input},
          {"scans", summary.scans},
          {"scans_by_status", statuses(summary)},
          {"first_stamp_s", summary.first_stamp_s},
          {"last_stamp_s", summary.last_stamp_s},
          {"path_m", summary.path_m},
          {"objects", summary.objects},
          {"objects_moving", summary.objects_moving},
          {"map_points", summary.map_points},
          {"bytes", scene.size()}};
}

ordered_json pose_json(const SE3& pose) {
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation();
  return {{"position_m", {p.x(), p.y(), p.z()}}, {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

ordered_json to_json(const SceneObject& object) {
  const Eigen::Vector4d sd = object.planar_covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return {{"id", object.id},
          {"class", to_string(object.object_class)},
          {"state", object.moving ? "moving" : "at_rest"},
          {"moving_probability", object.moving_probability},
          {"detected", object.detected},
          {"T_map_object", pose_json(object.T_map_object)},
          {"size_lwh_m", {object.size_lwh_m.x(), object.size_lwh_m.y(), object.size_lwh_m.z()}},
          {"velocity_mps", {object.velocity_map_mps.x(), object.velocity_map_mps.y()}},
          {"turn_rate_radps", object.turn_rate_radps},
          {"sd_x_m", sd(0)},
          {"sd_y_m", sd(1)},
          {"sd_yaw_rad", std::sqrt(std::max(0.0, object.yaw_covariance(0, 0)))}};
}

ordered_json to_json(const SceneState& state) {
  ordered_json objects = ordered_json::array();
  for (const SceneObject& object : state.objects) objects.push_back(to_json(object));
  ordered_json covariance = ordered_json::array();
  for (const auto& row : state.covariance.rowwise())
    covariance.push_back(std::vector<double>(row.begin(), row.end()));
  return {{"stamp_s", state.stamp_s},          {"nearest_frame", state.frame},
          {"status", to_string(state.status)}, {"T_map_lidar", pose_json(state.T_map_lidar)},
          {"covariance", covariance},          {"objects", objects}};
}

void print_state(const SceneState& state) {
  const Eigen::Vector3d& p = state.T_map_lidar.translation();
  const Eigen::Matrix<double, 6, 1> sd = state.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  print_row("time", fmt::format("{:.6f} s, nearest scan {} ({})", state.stamp_s, state.frame,
                                to_string(state.status)));
  print_row("robot",
            fmt::format("x {:.3f} y {:.3f} z {:.3f} m, yaw {:.2f} deg, standard deviations {:.4f} {:.4f} "
                        "{:.4f} m",
                        p.x(), p.y(), p.z(), yaw_deg(state.T_map_lidar), sd(0), sd(1), sd(2)));
  for (const SceneObject& object : state.objects) {
    const Eigen::Vector3d& q = object.T_map_object.translation();
    print_row("object", fmt::format("{} {}: x {:.2f} y {:.2f} z {:.2f} m, yaw {:.1f} deg, {}, {:.2f} m/s{}",
                                    object.id, to_string(object.object_class), q.x(), q.y(), q.z(),
                                    yaw_deg(object.T_map_object), object.moving ? "moving" : "at rest",
                                    object.velocity_map_mps.norm(), object.detected ? "" : ", predicted"));
  }
}

void run(const Options& options) {
  const SceneFile scene(options.file);
  if (options.stamp_s) {
    const SceneState state = state_at(scene, *options.stamp_s);
    options.json ? fmt::print("{}\n", to_json(state).dump(2)) : print_state(state);
  } else {
    const SceneSummary summary = summarize(scene);
    options.json ? fmt::print("{}\n", to_json(scene, summary).dump(2)) : print_summary(scene, summary);
  }
}

}  // namespace

void add_scene(CLI::App& program) {
  auto* command = program.add_subcommand("scene", "What a scene holds, or its state at a time");
  const auto options = std::make_shared<Options>();
  command->add_option("file", options->file, "scene.mlo of a run")->required()->type_name("FILE");
  command->add_option("--time", options->stamp_s, "Moment within the scene [s]")->type_name("T");
  command->add_flag("--json", options->json, "Print JSON");
  command->footer(kExplanation);
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
