#include "mlo/pipeline/move_results.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/core/heading.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/text.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/pipeline/object_table.hpp"
#include "mlo/scene/scene_file.hpp"
#include "mlo/scene/scene_writer.hpp"

namespace mlo {
namespace {

// A covariance of two or more vectors, each turned about the vertical.
template <int Size>
Eigen::Matrix<double, Size, Size> turned(const Eigen::Matrix<double, Size, Size>& covariance,
                                         const Eigen::MatrixXd& rotation) {
  Eigen::Matrix<double, Size, Size> R = Eigen::Matrix<double, Size, Size>::Zero();
  for (Eigen::Index i = 0; i < Size; i += rotation.rows()) {
    R.block(i, i, rotation.rows(), rotation.rows()) = rotation;
  }
  return R * covariance * R.transpose();
}

Eigen::Matrix2d planar_rotation(const SE3& correction) {
  return Eigen::Rotation2Dd(yaw_of(correction)).toRotationMatrix();
}

SceneScan moved(SceneScan scan, const SE3& correction) {
  scan.T_map_lidar = correction * scan.T_map_lidar;
  scan.covariance = turned<6>(scan.covariance, correction.rotation().toRotationMatrix());
  const Eigen::Matrix2d R = planar_rotation(correction);
  for (SceneObject& object : scan.objects) {
    object.T_map_object = correction * object.T_map_object;
    object.velocity_map_mps = R * object.velocity_map_mps;
    object.planar_covariance = turned<4>(object.planar_covariance, R);
  }
  return scan;
}

/// What the files beside the scene are made of.
struct MovedPoses {
  PoseList robot;    // of all scans
  PoseList stamped;  // of those that were not skipped
  ObjectTrajectories objects;
};

MovedPoses move_scene(const SceneFile& scene, const std::filesystem::path& file,
                      std::span<const SE3> corrections, std::span<const MapPoint> map,
                      const SceneConfig& config) {
  MovedPoses poses;
  SceneWriter writer(file, scene.meta(), config);
  for (std::size_t i = 0; i < scene.num_scans(); ++i) {
    const SceneScan scan = moved(scene.scan(i), corrections[i]);
    const SceneCloud cloud = scene.cloud(i);
    writer.write(scan, &cloud);
    const auto append = [&](PoseList& list) {
      list.frames.push_back(scan.frame);
      list.stamps_s.push_back(scan.stamp_s);
      list.T_world_body.push_back(scan.T_map_lidar);
    };
    append(poses.robot);
    if (scan.status != ScanStatus::skipped) append(poses.stamped);
    for (const SceneObject& object : scan.objects) {
      poses.objects.add({scan.frame, scan.stamp_s}, object.id, object.T_map_object);
    }
  }
  writer.write_map(map);
  for (const long id : scene.objects()) writer.write_object(id, scene.object(id));
  writer.finish();
  return poses;
}

PoseList in_camera_frame(PoseList poses, const SE3& T_camera_lidar) {
  for (SE3& pose : poses.T_world_body) pose = T_camera_lidar * pose * T_camera_lidar.inverse();
  return poses;
}

// The columns that objects.csv has in common with other tables come first; then track_state, heading and
// velocity.
std::string moved_row(std::string_view row, ObjectPose object, const SE3& correction) {
  const std::string common = objects_csv_header();
  const auto first = static_cast<std::size_t>(std::count(common.begin(), common.end(), ',')) + 1;
  const std::vector<std::string_view> cells = split_cells(row);
  const Eigen::Vector2d velocity_mps =
      planar_rotation(correction) * Eigen::Vector2d(parse_number(cells.at(first + 2)).value_or(0.0),
                                                    parse_number(cells.at(first + 3)).value_or(0.0));
  object.T_map_object = correction * object.T_map_object;
  std::string moved = fmt::format("{},{},{:.5f},{:.3f},{:.3f}", objects_csv_row(object), cells.at(first),
                                  yaw_of(object.T_map_object), velocity_mps.x(), velocity_mps.y());
  for (std::size_t i = first + 4; i < cells.size(); ++i) moved += fmt::format(",{}", cells[i]);
  return moved;
}

std::string moved_table(const std::filesystem::path& file, const std::map<std::size_t, SE3>& by_frame) {
  const std::string text = read_file(file);
  const std::vector<std::string_view> lines = split_lines(text);
  std::string moved = std::string(lines.at(0)) + '\n';
  std::size_t row = 0;
  for (const ObjectPose& object : read_objects_csv(file)) {
    moved += moved_row(lines.at(++row), object, by_frame.at(object.frame)) + '\n';
  }
  return moved;
}

}  // namespace

void move_results(const std::filesystem::path& folder, std::span<const SE3> corrections,
                  std::span<const MapPoint> map, const std::optional<SE3>& T_camera0_lidar,
                  const SceneConfig& config) {
  const std::filesystem::path scene = folder / "scene.mlo";
  const std::filesystem::path moved_scene = folder / "scene.mlo.part";
  const MovedPoses poses = move_scene(SceneFile(scene), moved_scene, corrections, map, config);
  std::filesystem::rename(moved_scene, scene);
  write_kitti_poses(folder / "trajectory.txt", poses.robot);
  write_tum_poses(folder / "trajectory_tum.txt", poses.stamped);
  if (T_camera0_lidar) {
    write_kitti_poses(folder / "trajectory_camera.txt", in_camera_frame(poses.robot, *T_camera0_lidar));
  }
  write_ply(folder / "static_map.ply", map);
  write_pcd(folder / "static_map.pcd", map);
  if (!std::filesystem::exists(folder / "objects.csv")) return;
  std::map<std::size_t, SE3> by_frame;
  for (std::size_t i = 0; i < corrections.size(); ++i) by_frame[poses.robot.frames[i]] = corrections[i];
  write_file_atomically(folder / "objects.csv", moved_table(folder / "objects.csv", by_frame));
  poses.objects.write(folder / "object_trajectories");
}

}  // namespace mlo
