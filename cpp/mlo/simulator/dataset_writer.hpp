#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mlo/core/types.hpp"
#include "mlo/simulator/ground_truth.hpp"
#include "mlo/simulator/lidar_model.hpp"
#include "mlo/simulator/simulate.hpp"

namespace mlo::simulator {

/// Everything about one scan that goes into files.
struct SimulatedFrame {
  std::size_t frame = 0;
  std::vector<Point> points;          ///< as they are to be written
  std::vector<std::uint32_t> labels;  ///< one per point
  std::vector<ObjectTruth> objects;
  std::vector<Detection> noisy, perfect;
  SE3 T_world_start, T_world_stamp, T_world_end;  ///< lidar poses
  std::string oxts;                               ///< a line
};

/// Writes the files of a simulation. Poses and maps are given in the map frame: that of the lidar at the
/// first stamp.
class DatasetWriter {
 public:
  /// Makes the folders and writes what is known at the beginning.
  DatasetWriter(std::filesystem::path out, const SimulationOptions& options, const SE3& T_map_world);

  void write(const SimulatedFrame& frame);
  /// Writes what spans all scans.
  void finish(const std::vector<MapPoint>& static_map);
  std::size_t labels_written() const { return labels_written_; }

 private:
  void write_sequence_files() const;

  std::filesystem::path out_;
  SimulationOptions options_;
  SE3 T_map_world_;
  Rig rig_;
  std::filesystem::path scans_, point_labels_;
  std::string label_02_, oxts_, objects_, poses_start_, poses_stamp_, poses_end_, poses_camera_, poses_imu_,
      times_;
  std::string noisy_, perfect_, noisy_ab3dmot_, perfect_ab3dmot_;
  std::size_t labels_written_ = 0;
};

/// The README of an output folder, and the same as JSON for programs.
std::string readme(const SimulationOptions& options);
std::string provenance_json(const SimulationOptions& options);

}  // namespace mlo::simulator
