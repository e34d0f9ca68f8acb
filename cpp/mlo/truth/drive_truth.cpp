#include "mlo/truth/drive_truth.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

// Records of the tracking benchmark have no stamps; they are taken with the scans.
void set_stamps_of_scans(std::vector<OxtsRecord>& records, const Dataset& dataset) {
  for (std::size_t i = 0; i < dataset.scans->size(); ++i) {
    for (OxtsRecord& record : records) {
      if (record.frame == dataset.scans->frame(i)) record.stamp_s = dataset.stamps_s[i];
    }
  }
}

// Those that can be used, in order of time: some drives have records that come twice or go back.
std::vector<OxtsRecord> usable(const std::vector<OxtsRecord>& records) {
  std::vector<OxtsRecord> kept;
  for (const OxtsRecord& record : records) {
    if (!record.stamp_s || !std::isfinite(*record.stamp_s) || !record.motion) continue;
    if (!kept.empty() && *record.stamp_s <= *kept.back().stamp_s) continue;
    kept.push_back(record);
  }
  return kept;
}

std::vector<OxtsRecord> records_of(const Dataset& dataset) {
  const fs::path raw = dataset.root / "oxts";
  const fs::path tracking =
      dataset.root.parent_path().parent_path() / "oxts" / (dataset.root.filename().string() + ".txt");
  std::vector<OxtsRecord> records;
  if (fs::is_directory(raw)) {
    records = read_oxts_records(raw);
  } else if (fs::is_regular_file(tracking)) {
    records = read_oxts_file(tracking);
    set_stamps_of_scans(records, dataset);
  } else {
    throw InputError(fmt::format("{}: no inertial records; looked for {} and {}", dataset.root.string(),
                                 raw.string(), tracking.string()));
  }
  records = usable(records);
  if (!records.empty()) return records;
  throw InputError(fmt::format("{}: none of the inertial records has a stamp and velocities (25 numbers)",
                               dataset.root.string()));
}

// Halfway between start and end of each sweep: from KITTI raw's files, else the stamps, which lie there.
std::vector<double> middles_s(const Dataset& dataset) {
  const fs::path folder = dataset.root / "velodyne_points";
  if (!fs::exists(folder / "timestamps_start.txt") || !fs::exists(folder / "timestamps_end.txt"))
    return dataset.stamps_s;
  const std::vector<double> start_s = read_stamps_s(folder / "timestamps_start.txt");
  const std::vector<double> end_s = read_stamps_s(folder / "timestamps_end.txt");
  std::vector<double> middles_s;
  for (std::size_t i = 0; i < dataset.scans->size(); ++i) {
    const std::size_t frame = dataset.scans->frame(i);
    const bool known = frame < start_s.size() && frame < end_s.size() && std::isfinite(start_s[frame]) &&
                       std::isfinite(end_s[frame]);
    middles_s.push_back(known ? 0.5 * (start_s[frame] + end_s[frame]) : dataset.stamps_s[i]);
  }
  return middles_s;
}

// From the IMU in the world to the lidar in the map.
LidarTruth in_map(const Dataset& dataset, std::span<const SmoothedPose> poses, const SE3& T_map_world,
                  const SE3& T_imu_lidar) {
  const Eigen::Matrix3d R_map_world = T_map_world.rotation().toRotationMatrix();
  LidarTruth truth;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const SmoothedPose& pose = poses[i];
    truth.poses.frames.push_back(dataset.scans->frame(i));
    truth.poses.stamps_s.push_back(pose.stamp_s);
    truth.poses.T_world_body.push_back(T_map_world * pose.T_world_imu * T_imu_lidar);
    const Eigen::Vector3d lever_world = pose.T_world_imu.rotation() * T_imu_lidar.translation();
    SmoothedPose::Matrix6d J = SmoothedPose::Matrix6d::Zero();
    J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = R_map_world;
    J.topRightCorner<3, 3>() = -R_map_world * skew(lever_world);
    truth.covariances.emplace_back(J * pose.covariance * J.transpose());
  }
  return truth;
}

}  // namespace

DriveTruth smooth_drive(const Dataset& dataset, const OxtsSmootherOptions& options) {
  if (!dataset.calibration.T_imu_lidar) {
    throw InputError(fmt::format(
        "{}: no calibration between IMU and lidar (calib_imu_to_velo.txt of the date's folder, or "
        "Tr_imu_velo in calib/NNNN.txt)",
        dataset.root.string()));
  }
  const std::vector<OxtsRecord> records = records_of(dataset);
  std::vector<double> stamps_s = dataset.stamps_s;
  const std::vector<double> middles = middles_s(dataset);
  const std::size_t scans = stamps_s.size();
  stamps_s.insert(stamps_s.end(), middles.begin(), middles.end());
  const std::vector<SmoothedPose> poses = smooth_oxts(records, stamps_s, options);
  if (scans == 0) return {};
  const SE3& T_imu_lidar = *dataset.calibration.T_imu_lidar;
  const SE3 T_map_world = (poses.front().T_world_imu * T_imu_lidar).inverse();
  const std::span<const SmoothedPose> all(poses);
  return {in_map(dataset, all.first(scans), T_map_world, T_imu_lidar),
          in_map(dataset, all.subspan(scans), T_map_world, T_imu_lidar)};
}

void write_covariances(const std::filesystem::path& file, const LidarTruth& truth) {
  static constexpr const char* kNames[] = {"x", "y", "z", "rx", "ry", "rz"};
  std::string content = "frame,stamp_s";
  for (int row = 0; row < 6; ++row) {
    for (int col = row; col < 6; ++col) content += fmt::format(",{}_{}", kNames[row], kNames[col]);
  }
  content += "\n";
  for (std::size_t i = 0; i < truth.covariances.size(); ++i) {
    content += fmt::format("{},{:.6f}", truth.poses.frames[i], truth.poses.stamps_s[i]);
    for (int row = 0; row < 6; ++row) {
      for (int col = row; col < 6; ++col) content += fmt::format(",{:.6e}", truth.covariances[i](row, col));
    }
    content += "\n";
  }
  write_file_atomically(file, content);
}

}  // namespace mlo
