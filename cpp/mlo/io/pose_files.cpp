#include "mlo/io/pose_files.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/oxts.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

// Files with few digits are off by 1e-3; anything beyond this is not a rotation at all.
constexpr double kRotationTolerance = 1e-2;

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
  return numbered(oxts_poses(read_oxts_file(file)));
}

PoseList read_oxts_folder(const fs::path& folder) {
  const std::vector<OxtsRecord> records = read_oxts_records(folder);
  PoseList poses;
  poses.T_world_body = oxts_poses(records);
  for (const OxtsRecord& record : records) {
    poses.frames.push_back(record.frame);
    if (record.stamp_s) poses.stamps_s.push_back(*record.stamp_s);
  }
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
