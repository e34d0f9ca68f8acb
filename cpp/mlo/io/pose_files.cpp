#include "mlo/io/pose_files.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/sequence_files.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

constexpr double kDegToRad = std::numbers::pi / 180.0;
// Files with few digits are off by 1e-3; anything beyond this is not a rotation at all.
constexpr double kRotationTolerance = 1e-2;

struct OxtsRecord {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;
  Eigen::Vector3d roll_pitch_yaw_rad = Eigen::Vector3d::Zero();
};

OxtsRecord parse_oxts(const std::string& line, const std::string& where) {
  constexpr std::size_t kFieldsUsed = 6;
  const std::vector<double> v = parse_numbers(line, where);
  if (v.size() < kFieldsUsed) {
    throw InputError(fmt::format("{}: {} numbers, an oxts record has 30", where, v.size()));
  }
  return {v[0], v[1], v[2], {v[3], v[4], v[5]}};
}

SE3 parse_kitti_pose(const std::string& line, const std::string& where) {
  const std::vector<double> row = parse_numbers(line, where);
  if (row.size() != 12) {
    throw InputError(fmt::format("{}: {} numbers, a KITTI pose has 12", where, row.size()));
  }
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topRows<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(row.data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const double error = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!matrix.allFinite() || !(error < kRotationTolerance) || R.determinant() < 0.0) {
    throw InputError(
        fmt::format("{}: no finite pose with a rotation; a KITTI pose is r11 r12 r13 tx r21 ...", where));
  }
  return SE3::from_matrix(matrix);
}

// Mercator projection, as KITTI's development kit defines the poses of its oxts data.
std::vector<SE3> project(const std::vector<OxtsRecord>& records) {
  constexpr double kEarthRadius = 6378137.0;
  std::vector<SE3> poses;
  if (records.empty()) return poses;
  const double scale = std::cos(records.front().latitude_deg * kDegToRad);
  const auto place = [&](const OxtsRecord& r) {
    return Eigen::Vector3d(
        scale * kEarthRadius * r.longitude_deg * kDegToRad,
        scale * kEarthRadius * std::log(std::tan((90.0 + r.latitude_deg) * kDegToRad / 2.0)), r.altitude_m);
  };
  const Eigen::Vector3d origin = place(records.front());
  for (const OxtsRecord& record : records) {
    const Eigen::Vector3d& angles = record.roll_pitch_yaw_rad;
    const Eigen::Quaterniond rotation = Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX());
    poses.emplace_back(rotation, place(record) - origin);
  }
  return poses;
}

// Where row i belongs to frame i.
PoseList numbered(std::vector<SE3> T_world_body) {
  PoseList poses;
  poses.frames.resize(T_world_body.size());
  std::iota(poses.frames.begin(), poses.frames.end(), std::size_t{0});
  poses.T_world_body = std::move(T_world_body);
  return poses;
}

// Stamps of some drives are not sorted or come twice: keeps those that grow. Poses without stamps give
// nothing.
PoseList in_order_of_time(const PoseList& poses) {
  PoseList ordered;
  for (std::size_t i = 0; i < poses.stamps_s.size(); ++i) {
    if (!ordered.stamps_s.empty() && poses.stamps_s[i] <= ordered.stamps_s.back()) continue;
    ordered.frames.push_back(poses.frames[i]);
    ordered.stamps_s.push_back(poses.stamps_s[i]);
    ordered.T_world_body.push_back(poses.T_world_body[i]);
  }
  return ordered;
}

// Between the neighbours in time; beyond the ends with the motion there. Needs two poses, stamps that grow.
SE3 pose_at(const PoseList& poses, double stamp_s) {
  const std::vector<double>& stamps_s = poses.stamps_s;
  const auto later = std::upper_bound(stamps_s.begin() + 1, stamps_s.end() - 1, stamp_s) - stamps_s.begin();
  const auto to = static_cast<std::size_t>(later);
  const SE3& T_world_from = poses.T_world_body[to - 1];
  const SE3 motion = T_world_from.inverse() * poses.T_world_body[to];
  const double fraction = (stamp_s - stamps_s[to - 1]) / (stamps_s[to] - stamps_s[to - 1]);
  return T_world_from * interpolate(motion, fraction);
}

}  // namespace

PoseList read_kitti_poses(const fs::path& file) {
  std::vector<SE3> poses;
  const std::vector<std::string> lines = read_lines(file);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string where = fmt::format("{}:{}", file.string(), i + 1);
    poses.push_back(parse_kitti_pose(lines[i], where));
  }
  return numbered(std::move(poses));
}

PoseList read_oxts_lines(const fs::path& file) {
  std::vector<OxtsRecord> records;
  const std::vector<std::string> lines = read_lines(file);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    records.push_back(parse_oxts(lines[i], fmt::format("{}:{}", file.string(), i + 1)));
  }
  return numbered(project(records));
}

PoseList read_oxts_folder(const fs::path& folder) {
  std::vector<double> stamps_s;
  if (const fs::path file = folder / "timestamps.txt"; fs::exists(file)) stamps_s = read_stamps_s(file);
  PoseList poses;
  std::vector<OxtsRecord> records;
  for (const ScanFile& entry : list_numbered_scans(folder / "data", ".txt")) {
    if (!fs::exists(entry.path)) continue;
    const std::vector<std::string> lines = read_lines(entry.path);
    if (lines.empty())
      throw InputError(fmt::format("{}: empty, an oxts record is needed", entry.path.string()));
    records.push_back(parse_oxts(lines.front(), fmt::format("{}:1", entry.path.string())));
    poses.frames.push_back(entry.frame);
  }
  poses.T_world_body = project(records);
  const bool all_known = std::all_of(poses.frames.begin(), poses.frames.end(), [&](std::size_t frame) {
    return frame < stamps_s.size() && std::isfinite(stamps_s[frame]);
  });
  if (!all_known) return poses;
  for (const std::size_t frame : poses.frames) poses.stamps_s.push_back(stamps_s[frame]);
  return poses;
}

PoseList rebased(PoseList poses, const SE3& T_body_other) {
  if (poses.T_world_body.empty()) return poses;
  const SE3 T_new_old = (poses.T_world_body.front() * T_body_other).inverse();
  for (SE3& T : poses.T_world_body) T = T_new_old * T * T_body_other;
  return poses;
}

PoseList poses_at(const std::vector<ScanFile>& scans, const PoseList& poses) {
  const PoseList timed = in_order_of_time(poses);
  PoseList result;
  const auto add = [&](const ScanFile& scan, const SE3& T_world_body) {
    result.frames.push_back(scan.frame);
    result.stamps_s.push_back(scan.stamp_s);
    result.T_world_body.push_back(T_world_body);
  };
  for (const ScanFile& scan : scans) {
    if (timed.stamps_s.size() > 1) {
      const bool covered = scan.stamp_s > timed.stamps_s.front() - scan.duration_s &&
                           scan.stamp_s < timed.stamps_s.back() + scan.duration_s;
      if (covered) add(scan, pose_at(timed, scan.stamp_s));
    } else if (const auto at = std::lower_bound(poses.frames.begin(), poses.frames.end(), scan.frame);
               at != poses.frames.end() && *at == scan.frame) {
      add(scan, poses.T_world_body[static_cast<std::size_t>(at - poses.frames.begin())]);
    }
  }
  return result;
}

std::optional<PoseList> lidar_truth(const std::vector<ScanFile>& scans, const PoseList& poses,
                                    const std::optional<SE3>& T_body_lidar, const std::string& origin,
                                    std::vector<std::string>& warnings) {
  if (!T_body_lidar) {
    warnings.push_back(
        fmt::format("{}: of no use without the calibration between its body and the lidar", origin));
    return std::nullopt;
  }
  PoseList truth = rebased(poses_at(scans, poses), *T_body_lidar);
  if (truth.frames.size() < scans.size()) {
    warnings.push_back(
        fmt::format("{}: poses for {} of {} scans", origin, truth.frames.size(), scans.size()));
  }
  return truth.frames.empty() ? std::nullopt : std::optional<PoseList>(std::move(truth));
}

}  // namespace mlo
