#include "mlo/io/kitti_odometry.hpp"

#include <utility>

#include "mlo/io/calibration.hpp"
#include "mlo/io/pose_files.hpp"
#include "mlo/io/text.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

// The object benchmark also has velodyne/NNNNNN.bin, but neither of the two files nor a number for a name.
bool is_odometry_sequence(const fs::path& folder) {
  return holds_files(folder / "velodyne", ".bin") &&
         (fs::exists(folder / "times.txt") || fs::exists(folder / "calib.txt") ||
          parse_count(folder.filename().string()));
}

// Camera poses: dataset/poses/NN.txt beside dataset/sequences, or in the sequence's own folder.
fs::path poses_file(const SequenceFolder& sequence) {
  const fs::path own = sequence.path / "poses.txt";
  return fs::exists(own) ? own
                         : sequence.path.parent_path().parent_path() / "poses" / (sequence.name + ".txt");
}

}  // namespace

std::vector<SequenceFolder> find_kitti_odometry(const fs::path& folder) {
  std::vector<fs::path> candidates{folder.filename() == "velodyne" ? folder.parent_path() : folder};
  for (const fs::path& parent : {folder, folder / "sequences", folder / "dataset" / "sequences"}) {
    for (const fs::path& child : subfolders(parent)) candidates.push_back(child);
  }
  std::vector<SequenceFolder> sequences;
  for (const fs::path& candidate : candidates) {
    const std::string name = candidate.filename().string();
    if (is_odometry_sequence(candidate)) sequences.push_back({name, parse_count(name), candidate});
  }
  return sequences;
}

Dataset open_kitti_odometry(const SequenceFolder& sequence, const OpenOptions& options) {
  Dataset dataset;
  dataset.format = "kitti_odometry";
  dataset.sequence = sequence.name;
  dataset.root = sequence.path;
  dataset.sensor = options.sensor.value_or(hdl64e());

  const fs::path times = sequence.path / "times.txt";
  std::vector<double> stamps_s;
  if (fs::exists(times)) stamps_s = read_stamps_s(times);
  const double period_s = median_period_s(stamps_s, 1.0 / dataset.sensor.rate_hz);
  std::vector<ScanFile> scans = list_numbered_scans(sequence.path / "velodyne", ".bin");
  for (ScanFile& scan : scans) scan.duration_s = period_s;
  dataset.warnings = set_stamps(scans, stamps_by_frame(scans, stamps_s), period_s, times.string());
  if (const fs::path file = sequence.path / "calib.txt"; fs::exists(file)) {
    dataset.calibration = read_calibration_file(file);
  }
  if (const fs::path file = poses_file(sequence); fs::exists(file)) {
    dataset.truth = lidar_truth(scans, read_kitti_poses(file), dataset.calibration.T_camera0_lidar,
                                file.string(), dataset.warnings);
  }
  set_scans(dataset, std::move(scans),
            {.sensor = dataset.sensor, .stamp_fraction = 0.5, .motion_compensated = true});
  return dataset;
}

}  // namespace mlo
