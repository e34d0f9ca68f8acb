#include "mlo/pipeline/run_output.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/trajectory_file.hpp"

namespace mlo {
namespace {

constexpr const char* kTrajectory = "trajectory.txt";
constexpr const char* kTrajectoryTum = "trajectory_tum.txt";
constexpr const char* kTrajectoryCamera = "trajectory_camera.txt";
constexpr const char* kOdometry = "odometry.txt";
constexpr const char* kPerScan = "per_scan.csv";
constexpr const char* kObjects = "objects.csv";
constexpr const char* kUnknownMovers = "unknown_movers.csv";
constexpr const char* kScene = "scene.mlo";

constexpr std::string_view kPerScanHeader =
    "frame,stamp_s,status,x_m,y_m,z_m,odometry_status,consistency_passed,consistent_share,"
    "refinement_status,degenerate_directions,matches,iterations,rms_residual_m,points,ground_points,"
    "ground_features,edge_features,surface_features,candidates,objects,object_points,ambiguous_points";

constexpr std::string_view kUnknownMoversHeader =
    "frame,stamp_s,id,x_m,y_m,z_m,size_x_m,size_y_m,size_z_m,vx_mps,vy_mps,points";

std::filesystem::path create_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw InputError(fmt::format("{}: the folder cannot be created ({}); choose another with --out",
                                 folder.string(), error.message()));
  }
  return folder;
}

SceneMeta scene_meta(const Dataset& dataset, const PipelineConfig& config) {
  return {.program_version = MLO_VERSION,
          .input = dataset.root.string(),
          .format = dataset.format,
          .sequence = dataset.sequence,
          .configuration = to_yaml(config),
          .T_camera0_lidar = dataset.calibration.T_camera0_lidar};
}

std::string per_scan_row(const FrameResult& result) {
  const Eigen::Vector3d& p = result.T_map_lidar.translation();
  const PerceptCounts& counts = result.counts;
  std::string row = fmt::format(
      "{},{:.6f},{},{:.4f},{:.4f},{:.4f},{},{},{:.4f},{},{},{},{},{:.5f},{},{},{},{},{},{},{},{},{}",
      result.frame, result.stamp_s, result.first ? "first" : (result.localised() ? "localised" : "predicted"),
      p.x(), p.y(), p.z(), to_string(result.odometry.status),
      result.consistency.run ? (result.consistency.passed ? "yes" : "no") : "not_run",
      result.consistency.share, to_string(result.refinement.status), result.refinement.degenerate_directions,
      result.refinement.num_matches, result.refinement.iterations, result.refinement.rms_residual_m,
      counts.points, counts.ground_points, counts.ground_features, counts.edge_features,
      counts.surface_features, counts.candidates, counts.objects, counts.object_points,
      counts.ambiguous_points);
  for (const double ms : result.times.ms) row += fmt::format(",{:.2f}", ms);
  return row + ",";
}

std::string unknown_mover_row(std::size_t frame, double stamp_s, const UnknownMover& mover) {
  const Eigen::Vector3d& p = mover.center_map;
  const Eigen::Vector3d& size = mover.size_m;
  return fmt::format("{},{:.6f},{},{:.3f},{:.3f},{:.3f},{:.2f},{:.2f},{:.2f},{:.3f},{:.3f},{}", frame,
                     stamp_s, mover.id, p.x(), p.y(), p.z(), size.x(), size.y(), size.z(),
                     mover.velocity_map_mps.x(), mover.velocity_map_mps.y(), mover.num_points);
}

}  // namespace

RunOutput::RunOutput(const std::filesystem::path& folder, const Dataset& dataset,
                     const PipelineConfig& config, bool with_objects)
    : folder_(create_folder(folder)), T_camera_lidar_(dataset.calibration.T_camera0_lidar) {
  const auto create = [&](const char* name) { files_.try_emplace(name, folder / name); };
  for (const char* name : {kTrajectory, kTrajectoryTum, kOdometry, kPerScan}) create(name);
  if (T_camera_lidar_) create(kTrajectoryCamera);
  if (with_objects) create(kObjects);
  const bool with_unknown = config.mapping.unknown_movers.every > 0;
  if (with_unknown) create(kUnknownMovers);
  if (config.scene.write) scene_.emplace(folder / kScene, scene_meta(dataset, config), config.scene);
  std::string header(kPerScanHeader);
  for (const std::string_view stage : kStageNames) header += fmt::format(",{}_ms", stage);
  write_row(kPerScan, header + ",problem");
  if (with_objects) write_row(kObjects, object_table_header());
  if (with_unknown) write_row(kUnknownMovers, std::string(kUnknownMoversHeader));
}

RunOutput::RunOutput(const std::filesystem::path& folder, const Dataset& dataset,
                     const PipelineConfig& config, RunOutputState state)
    : folder_(folder),
      T_camera_lidar_(dataset.calibration.T_camera0_lidar),
      object_trajectories_(std::move(state.object_trajectories)) {
  for (const auto& [name, size] : state.sizes) files_.try_emplace(name, folder / name, size);
  if (state.scene) scene_.emplace(folder / kScene, std::move(*state.scene), config.scene);
}

RunOutputState RunOutput::state() {
  RunOutputState state{.object_trajectories = object_trajectories_};
  for (const auto& [name, file] : files_) state.sizes[name] = file.size();
  if (scene_) state.scene = scene_->state();
  return state;
}

bool RunOutput::with_objects() const {
  return files_.contains(kObjects);
}

void RunOutput::write_row(const char* file, const std::string& row) {
  files_.at(file).append(row + '\n');
}

void RunOutput::write_poses(const SE3& T_map_lidar, const SE3& T_odom_lidar) {
  write_row(kTrajectory, kitti_row(T_map_lidar));
  write_row(kOdometry, kitti_row(T_odom_lidar));
  if (T_camera_lidar_) {
    write_row(kTrajectoryCamera, kitti_row(*T_camera_lidar_ * T_map_lidar * T_camera_lidar_->inverse()));
  }
}

void RunOutput::write(FrameResult result) {
  if (scene_) scene_->wait();  // so that it is never more than one scan behind
  write_poses(result.T_map_lidar, result.T_odom_lidar);
  write_row(kTrajectoryTum, tum_row(result.stamp_s, result.T_map_lidar));
  write_row(kPerScan, per_scan_row(result));
  if (with_objects()) write_objects(result);
  for (const UnknownMover& mover : result.unknown_movers) {
    write_row(kUnknownMovers, unknown_mover_row(result.frame, result.stamp_s, mover));
  }
  write_object_maps(result.finished_objects);
  if (scene_) scene_->write(std::move(result));
}

void RunOutput::write_objects(const FrameResult& result) {
  const ObjectRow place{result.frame, result.stamp_s};
  for (const TrackedObject& object : result.objects) {
    if (!object.reported) continue;
    write_row(kObjects, object_table_row(place, object));
    object_trajectories_.add(place, object.id, object.T_map_object);
  }
}

void RunOutput::write_object_maps(std::span<const MappedObject> objects) {
  for (const MappedObject& object : objects) {
    if (object.points_object.empty() || !object_trajectories_.contains(object.id)) continue;
    std::vector<MapPoint> points;
    for (const Eigen::Vector3f& p : object.points_object) points.push_back({p, 0.0F, MapLabel::object});
    write_ply(create_folder(folder_ / "object_maps") / fmt::format("{:05}.ply", object.id), points);
    if (scene_) scene_->write_object(object);
  }
}

void RunOutput::write_object_trajectories() const {
  if (with_objects()) object_trajectories_.write(folder_ / "object_trajectories");
}

void RunOutput::write_skipped(std::size_t frame, double stamp_s, const std::string& problem,
                              const PredictedPoses& predicted) {
  if (scene_) scene_->write_skipped(frame, stamp_s, problem, predicted);
  write_poses(predicted.T_map_lidar, predicted.T_odom_lidar);
  std::string quoted;
  for (const char c : problem) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  const auto columns = static_cast<std::size_t>(
      std::count(kPerScanHeader.begin(), kPerScanHeader.end(), ',') + 1 + static_cast<long>(kNumStages));
  write_row(kPerScan, fmt::format("{},,skipped{}\"{}\"", frame, std::string(columns - 2, ','), quoted));
}

void RunOutput::write_map(std::span<const MapPoint> points) {
  write_ply(folder_ / "static_map.ply", points);
  write_pcd(folder_ / "static_map.pcd", points);
  if (scene_) scene_->write_map(points);
}

void RunOutput::finish() {
  if (scene_) scene_->finish();
}

}  // namespace mlo
