#include "mlo/io/kitti_tracking.hpp"

#include <utility>

#include "mlo/io/calibration.hpp"
#include "mlo/io/pose_files.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

bool is_tracking_sequence(const fs::path& folder) {
  return folder.parent_path().filename() == "velodyne" && parse_count(folder.filename().string()) &&
         holds_files(folder, ".bin");
}

std::optional<PoseList> find_truth(const fs::path& part, const std::string& file_name,
                                   const std::vector<ScanFile>& scans, Dataset& dataset) {
  const std::optional<SE3>& T_imu_lidar = dataset.calibration.T_imu_lidar;
  if (const fs::path oxts = part / "oxts" / file_name; fs::exists(oxts)) {
    return lidar_truth(scans, read_oxts_lines(oxts), T_imu_lidar, oxts.string(), dataset.warnings);
  }
  if (const fs::path poses = part / "poses_imu" / file_name; fs::exists(poses)) {
    return lidar_truth(scans, read_kitti_poses(poses), T_imu_lidar, poses.string(), dataset.warnings);
  }
  return std::nullopt;
}

}  // namespace

std::vector<SequenceFolder> find_kitti_tracking(const fs::path& folder) {
  std::vector<fs::path> candidates{folder};
  for (const fs::path& velodyne : {folder / "training" / "velodyne", folder / "velodyne", folder}) {
    for (const fs::path& child : subfolders(velodyne)) candidates.push_back(child);
  }
  std::vector<SequenceFolder> sequences;
  for (const fs::path& candidate : candidates) {
    const std::string name = candidate.filename().string();
    if (is_tracking_sequence(candidate)) sequences.push_back({name, parse_count(name), candidate});
  }
  return sequences;
}

Dataset open_kitti_tracking(const SequenceFolder& sequence, const OpenOptions& options) {
  Dataset dataset;
  dataset.format = "kitti_tracking";
  dataset.sequence = sequence.name;
  dataset.root = sequence.path;
  dataset.sensor = options.sensor.value_or(hdl64e());

  const fs::path part = sequence.path.parent_path().parent_path();
  const std::string file_name = sequence.name + ".txt";
  std::vector<ScanFile> scans = list_numbered_scans(sequence.path, ".bin");
  for (ScanFile& scan : scans) {
    scan.duration_s = 1.0 / dataset.sensor.rate_hz;
    scan.stamp_s = static_cast<double>(scan.frame) * scan.duration_s;
  }
  if (const fs::path file = part / "calib" / file_name; fs::exists(file)) {
    dataset.calibration = read_calibration_file(file);
  }
  dataset.truth = find_truth(part, file_name, scans, dataset);
  if (const fs::path file = part / "label_02" / file_name; fs::exists(file)) dataset.labels = file;
  set_scans(dataset, std::move(scans),
            {.sensor = dataset.sensor, .stamp_fraction = 0.5, .motion_compensated = false});
  return dataset;
}

}  // namespace mlo
