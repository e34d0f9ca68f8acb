#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "mlo/core/sensor.hpp"
#include "mlo/simulator/detection_noise.hpp"
#include "mlo/simulator/lidar_model.hpp"
#include "mlo/simulator/scene.hpp"

namespace mlo::simulator {

/// Which of KITTI's folder layouts is written. With tracking, scans are as the sensor gives them; with
/// odometry they are motion-compensated and rounded to 1 mm, as those of that benchmark are. The elevations
/// of both carry the bias that readers correct (SensorConfig::vertical_correction_deg).
enum class Layout { tracking, odometry };

/// The HDL-64E as KITTI's car spins it: 2160 firings per revolution.
SensorConfig default_sensor();

struct SimulationOptions {
  SceneOptions scene;
  Layout layout = Layout::tracking;
  SensorConfig sensor = default_sensor();
  LidarErrors errors;  ///< its elevation bias is set by the sensor
  DetectorErrors detector;
  std::size_t max_scans = 0;  ///< 0: the whole drive
  double map_voxel_m = 0.2;   ///< spacing of the true static map's points
  bool overwrite = false;     ///< replace an earlier simulation in the folder
  std::string version;        ///< of the program, for the record
};

struct SimulationReport {
  std::size_t scans = 0;
  std::size_t points = 0;
  std::size_t objects = 0;  ///< that were within reach at least once
  std::size_t labels = 0;   ///< lines of the label file
  std::size_t map_points = 0;
  double way_m = 0.0;
};

/// Drives through a scene and writes scans, calibration, labels, poses and further truth into a folder, with
/// a README that says what is what and that all of it is synthetic.
/// @param progress  called after each scan with the number done and the total; may be empty
/// @throws InputError when options or folder cannot be used
SimulationReport simulate(const SimulationOptions& options, const std::filesystem::path& out,
                          const std::function<void(std::size_t done, std::size_t total)>& progress);

}  // namespace mlo::simulator
