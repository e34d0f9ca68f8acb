#include "mlo/io/kitti_raw.hpp"

#include <cmath>
#include <utility>

#include "mlo/io/calibration.hpp"
#include "mlo/io/pose_files.hpp"
#include "mlo/io/text.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

bool is_drive(const fs::path& folder) {
  return holds_files(folder / "velodyne_points" / "data", ".bin");
}

// "2011_09_26_drive_0005_sync" is number 5.
std::optional<std::size_t> drive_number(const std::string& name) {
  const std::string marker = "_drive_";
  const std::size_t at = name.find(marker);
  if (at == std::string::npos) return std::nullopt;
  const std::size_t begin = at + marker.size();
  return parse_count(name.substr(begin, name.find('_', begin) - begin));
}

std::vector<double> read_stamps_if_there(const fs::path& file) {
  return fs::exists(file) ? read_stamps_s(file) : std::vector<double>{};
}

// From the start of each sweep to its end, where both are known; otherwise the period.
void set_durations(std::vector<ScanFile>& scans, const fs::path& folder, double period_s) {
  const std::vector<double> start_s = read_stamps_if_there(folder / "timestamps_start.txt");
  const std::vector<double> end_s = read_stamps_if_there(folder / "timestamps_end.txt");
  for (ScanFile& scan : scans) {
    const bool known = scan.frame < start_s.size() && scan.frame < end_s.size();
    const double duration_s = known ? end_s[scan.frame] - start_s[scan.frame] : period_s;
    scan.duration_s = duration_s > 0.0 ? duration_s : period_s;
  }
}

}  // namespace

std::vector<SequenceFolder> find_kitti_raw(const fs::path& folder) {
  std::vector<fs::path> candidates{folder};
  if (folder.filename() == "velodyne_points") candidates.push_back(folder.parent_path());
  if (folder.filename() == "data") candidates.push_back(folder.parent_path().parent_path());
  for (const fs::path& child : subfolders(folder)) {
    candidates.push_back(child);
    for (const fs::path& grandchild : subfolders(child)) candidates.push_back(grandchild);
  }
  std::vector<SequenceFolder> drives;
  for (const fs::path& candidate : candidates) {
    const std::string name = candidate.filename().string();
    if (is_drive(candidate)) drives.push_back({name, drive_number(name), candidate});
  }
  return drives;
}

Dataset open_kitti_raw(const SequenceFolder& drive, const OpenOptions& options) {
  Dataset dataset;
  dataset.format = "kitti_raw";
  dataset.sequence = drive.name;
  dataset.root = drive.path;
  dataset.sensor = options.sensor.value_or(hdl64e());

  const fs::path folder = drive.path / "velodyne_points";
  const std::vector<double> stamps_s = read_stamps_if_there(folder / "timestamps.txt");
  const double period_s = median_period_s(stamps_s, 1.0 / dataset.sensor.rate_hz);
  std::vector<ScanFile> scans = list_numbered_scans(folder / "data", ".bin");
  dataset.warnings =
      set_stamps(scans, stamps_by_frame(scans, stamps_s), period_s, (folder / "timestamps.txt").string());
  set_durations(scans, folder, period_s);
  dataset.calibration = read_raw_calibration(drive.path.parent_path());
  if (const fs::path oxts = drive.path / "oxts"; fs::exists(oxts / "data")) {
    dataset.truth = lidar_truth(scans, read_oxts_folder(oxts), dataset.calibration.T_imu_lidar, oxts.string(),
                                dataset.warnings);
  }
  set_scans(dataset, std::move(scans),
            {.sensor = dataset.sensor, .stamp_fraction = 0.5, .motion_compensated = false});
  return dataset;
}

}  // namespace mlo
