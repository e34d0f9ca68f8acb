#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>

#include "mlo/core/types.hpp"
#include "mlo/io/dataset.hpp"
#include "mlo/pipeline/config.hpp"
#include "mlo/pipeline/frame_result.hpp"
#include "mlo/pipeline/object_table.hpp"
#include "mlo/pipeline/scene_output.hpp"

namespace mlo {

/// The files of one run. Rows are written scan by scan and are on disk when a run is killed.
class RunOutput {
 public:
  /// Creates the folder and the files in it; files of an earlier run are replaced.
  /// @param dataset       where it knows its camera, trajectory_camera.txt is written too
  /// @param with_objects  objects.csv is written too
  /// @throws InputError when the folder or a file cannot be written
  RunOutput(const std::filesystem::path& folder, const Dataset& dataset, const PipelineConfig& config,
            bool with_objects);

  /// trajectory.txt, trajectory_tum.txt, odometry.txt, trajectory_camera.txt, a row of per_scan.csv, and the
  /// scene.
  /// @throws InputError when the disk is full
  void write(FrameResult result);
  /// For a scan that could not be used: a row of per_scan.csv with the problem, and the predicted poses in
  /// the files whose row numbers are frame numbers (not in trajectory_tum.txt) and in the scene.
  /// @param stamp_s  when the scan should have been taken
  void write_skipped(std::size_t frame, double stamp_s, const std::string& problem,
                     const PredictedPoses& predicted);

  /// object_maps/ID.ply, in the object's own frame, of those that were reported.
  void write_object_maps(std::span<const MappedObject> objects) const;

  /// object_trajectories/ID.txt, of all objects that were reported.
  void write_object_trajectories() const;

  /// static_map.ply and static_map.pcd, and the map of the scene.
  void write_map(std::span<const MapPoint> points);

  /// Ends the scene.
  void finish();

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
  std::optional<SceneOutput> scene_;
};

}  // namespace mlo
