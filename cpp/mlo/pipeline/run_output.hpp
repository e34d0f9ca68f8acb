#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "mlo/core/types.hpp"
#include "mlo/io/append_file.hpp"
#include "mlo/io/dataset.hpp"
#include "mlo/pipeline/config.hpp"
#include "mlo/pipeline/frame_result.hpp"
#include "mlo/pipeline/object_table.hpp"
#include "mlo/pipeline/scene_output.hpp"

namespace mlo {

/// How far the files of a run are written (core/archive.hpp).
struct RunOutputState {
  std::map<std::string, std::uint64_t> sizes = {};  ///< of the text files, by name
  ObjectTrajectories object_trajectories = {};
  std::optional<SceneWriterState> scene = {};

  static void archive(auto& self, auto& bytes) { bytes(self.sizes, self.object_trajectories, self.scene); }
};

/// The files of one run. Rows are written scan by scan and are on disk when a run is killed.
class RunOutput {
 public:
  /// Creates the folder and the files in it; files of an earlier run are replaced.
  /// @param dataset       where it knows its camera, trajectory_camera.txt is written too
  /// @param with_objects  objects.csv is written too
  /// @throws InputError when the folder or a file cannot be written
  RunOutput(const std::filesystem::path& folder, const Dataset& dataset, const PipelineConfig& config,
            bool with_objects);
  /// Goes on with the files of an earlier run where it was; what they have beyond that is cut off.
  RunOutput(const std::filesystem::path& folder, const Dataset& dataset, const PipelineConfig& config,
            RunOutputState state);

  /// trajectory.txt, trajectory_tum.txt, odometry.txt, trajectory_camera.txt, a row of per_scan.csv, rows of
  /// unknown_movers.csv, and the scene.
  /// @throws InputError when the disk is full
  void write(FrameResult result);
  /// For a scan that could not be used: a row of per_scan.csv with the problem, and the predicted poses in
  /// the files whose row numbers are frame numbers (not in trajectory_tum.txt) and in the scene.
  /// @param stamp_s  when the scan should have been taken
  void write_skipped(std::size_t frame, double stamp_s, const std::string& problem,
                     const PredictedPoses& predicted);

  /// object_maps/ID.ply, in the object's own frame, of those that were reported, and the same in the scene.
  void write_object_maps(std::span<const MappedObject> objects);

  /// object_trajectories/ID.txt, of all objects that were reported.
  void write_object_trajectories() const;

  /// static_map.ply and static_map.pcd, and the map of the scene.
  void write_map(std::span<const MapPoint> points);

  /// Ends the scene.
  void finish();

  /// With all that was given so far.
  RunOutputState state();

 private:
  void write_objects(const FrameResult& result);
  void write_poses(const SE3& T_map_lidar, const SE3& T_odom_lidar);
  /// Each row is with the system at once, so that errors surface at the row that met them.
  void write_row(const char* file, const std::string& row);
  bool with_objects() const;

  std::filesystem::path folder_;
  std::optional<SE3> T_camera_lidar_;
  std::map<std::string, AppendFile> files_;  // by name
  ObjectTrajectories object_trajectories_;
  std::optional<SceneOutput> scene_;
};

}  // namespace mlo
