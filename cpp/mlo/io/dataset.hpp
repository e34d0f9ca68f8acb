#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mlo/core/se3.hpp"
#include "mlo/core/sensor.hpp"
#include "mlo/core/types.hpp"

namespace mlo {

/// One attempt to read a scan: the scan, or why there is none.
struct ScanReading {
  std::optional<Scan> scan;
  std::string problem;             ///< file, what is wrong and the remedy; empty when there is a scan
  bool missing = false;            ///< there is no file at all
  std::size_t invalid_points = 0;  ///< left out: coordinates NaN, infinite, or all zero (no return)
};

/// A sequence of scans on disk. Small, immutable, read by index from any thread.
class ScanSource {
 public:
  virtual ~ScanSource() = default;
  /// Number of scans that should be there; missing files in the middle of a numbered sequence count.
  virtual std::size_t size() const = 0;
  /// Number of the scan in its sequence (its file name where that is a number).
  virtual std::size_t frame(std::size_t index) const = 0;
  /// Points with ring and sweep fraction, in the order of the file. Never throws for bad content.
  virtual ScanReading read(std::size_t index) const = 0;
};

/// Poses with the frames they belong to.
struct PoseList {
  std::vector<std::size_t> frames;
  std::vector<double> stamps_s;  ///< empty where the format has none
  std::vector<SE3> T_world_body;
  static void archive(auto& self, auto& bytes) { bytes(self.frames, self.stamps_s, self.T_world_body); }
};

/// KITTI calibration, as far as the folder has it.
struct Calibration {
  std::optional<SE3> T_camera0_lidar;  ///< rectified camera 0 (R0_rect included)
  std::optional<SE3> T_imu_lidar;
  std::optional<Eigen::Matrix<double, 3, 4>> P2;  ///< rectified camera 0 to image 2 [px]
};

/// What was found in a folder.
struct Dataset {
  std::string format;    ///< kitti_odometry, kitti_raw, kitti_tracking or folder
  std::string sequence;  ///< its name; empty for a plain folder
  std::filesystem::path root;
  std::unique_ptr<ScanSource> scans;
  std::vector<double> stamps_s;  ///< of each scan, as far as known without reading it
  Calibration calibration;
  /// Lidar poses at the scans' stamps in the lidar frame at the first of them, where the data has them.
  std::optional<PoseList> truth;
  std::filesystem::path labels;  ///< annotated objects that come along (KITTI tracking labels); empty: none
  SensorConfig sensor;           ///< what this kind of data is known to come from
  std::vector<std::string> warnings;  ///< what looks wrong, one sentence each
};

struct OpenOptions {
  std::string format = "auto";
  std::string sequence = {};  ///< required where the folder holds several
  /// Instead of the one that this kind of data is known to come from.
  std::optional<SensorConfig> sensor = {};
};

/// Opens a folder of scans; the layout is recognised from what lies in it.
/// @throws InputError naming the folder, what was looked for, and the remedy
Dataset open_dataset(const std::filesystem::path& folder, const OpenOptions& options);

}  // namespace mlo
