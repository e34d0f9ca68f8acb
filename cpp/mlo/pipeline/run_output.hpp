#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>

#include "mlo/core/types.hpp"
#include "mlo/pipeline/frame_result.hpp"
#include "mlo/pipeline/object_table.hpp"

namespace mlo {

/// The files of one run. Rows are written scan by scan and are on disk when a run is killed.
class RunOutput {
 public:
  /// Creates the folder and the files in it; files of an earlier run are replaced.
  /// @param T_camera_lidar  where known, trajectory_camera.txt is written too
  /// @throws InputError when the folder or a file cannot be written
  /// @param with_objects    objects.csv is written too
  RunOutput(const std::filesystem::path& folder, const std::optional<SE3>& T_camera_lidar, bool with_objects);

  /// trajectory.txt, trajectory_tum.txt, odometry.txt, trajectory_camera.txt and a row of per_scan.csv.
  /// @throws InputError when the disk is full
  void write(const FrameResult& result);
  /// For a scan that could not be used: a row of per_scan.csv with the problem, and the predicted poses in
  /// the files whose row numbers are frame numbers (not in trajectory_tum.txt).
  void write_skipped(std::size_t frame, const std::string& problem, const PredictedPoses& predicted);

  /// object_maps/ID.ply, in the object's own frame, of those that were reported.
  void write_object_maps(std::span<const MappedObject> objects) const;

  /// object_trajectories/ID.txt, of all objects that were reported.
  void write_object_trajectories() const;

  /// static_map.ply and static_map.pcd.
  void write_map(std::span<const MapPoint> points) const;

 private:
  void write_objects(const FrameResult& result);
  void write_poses(const SE3& T_map_lidar, const SE3& T_odom_lidar);

  /// A text file that is flushed after each row, so that errors surface at the row that met them.
  struct TextFile {
    std::filesystem::path path;
    std::ofstream stream;

    explicit TextFile(const std::filesystem::path& file);
    void write_row(const std::string& row);
  };

  std::filesystem::path folder_;
  std::optional<SE3> T_camera_lidar_;
  TextFile trajectory_;
  TextFile trajectory_tum_;
  TextFile odometry_;
  TextFile per_scan_;
  std::optional<TextFile> trajectory_camera_;
  std::optional<TextFile> objects_;
  ObjectTrajectories object_trajectories_;
};

}  // namespace mlo
