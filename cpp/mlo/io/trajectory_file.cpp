#include "mlo/io/trajectory_file.hpp"

#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/pose_files.hpp"
#include "mlo/io/text.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

constexpr std::size_t kKittiNumbers = 12;
constexpr std::size_t kTumNumbers = 8;
constexpr double kQuaternionTolerance = 1e-2;

SE3 tum_pose(const std::vector<double>& row, const std::string& where) {
  const Eigen::Quaterniond q(row[7], row[4], row[5], row[6]);
  SE3 pose(q, {row[1], row[2], row[3]});
  if (!(std::abs(q.norm() - 1.0) < kQuaternionTolerance) || !pose.is_finite() || !std::isfinite(row[0])) {
    throw InputError(fmt::format(
        "{}: no finite pose with a quaternion of length 1; TUM rows are stamp tx ty tz qx qy qz qw", where));
  }
  return pose;
}

bool is_blank_or_comment(const std::string& line) {
  const std::vector<std::string_view> words = split_words(line);
  return words.empty() || words.front().starts_with('#');
}

}  // namespace

PoseList read_trajectory(const std::filesystem::path& path) {
  const std::vector<std::string> lines = read_lines(path);
  PoseList poses;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (is_blank_or_comment(lines[i])) continue;
    const std::string where = fmt::format("{}:{}", path.string(), i + 1);
    const std::vector<double> row = parse_numbers(lines[i], where);
    if (row.size() == kKittiNumbers && poses.frames.empty()) return read_kitti_poses(path);
    if (row.size() != kTumNumbers) {
      throw InputError(
          fmt::format("{}: {} numbers; expected 12 in every row (KITTI) or 8 (TUM)", where, row.size()));
    }
    poses.frames.push_back(poses.frames.size());
    poses.stamps_s.push_back(row[0]);
    poses.T_world_body.push_back(tum_pose(row, where));
  }
  return poses;
}

std::string kitti_row(const SE3& pose) {
  const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = pose.matrix().topRows<3>();
  return fmt::format("{}", fmt::join(rows.data(), rows.data() + rows.size(), " "));
}

std::string tum_row(double stamp_s, const SE3& pose) {
  const Eigen::Vector3d& t = pose.translation();
  Eigen::Quaterniond q = pose.rotation();
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  return fmt::format("{} {} {} {} {} {} {} {}", stamp_s, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

void write_kitti_poses(const std::filesystem::path& path, const PoseList& poses) {
  std::string text;
  for (const SE3& pose : poses.T_world_body) text += kitti_row(pose) + '\n';
  write_file_atomically(path, text);
}

void write_tum_poses(const std::filesystem::path& path, const PoseList& poses) {
  if (poses.stamps_s.size() != poses.T_world_body.size()) {
    throw InputError(
        fmt::format("{}: TUM rows need a stamp for every pose, but there are {} stamps and {} poses",
                    path.string(), poses.stamps_s.size(), poses.T_world_body.size()));
  }
  std::string text;
  for (std::size_t i = 0; i < poses.T_world_body.size(); ++i) {
    text += tum_row(poses.stamps_s[i], poses.T_world_body[i]) + '\n';
  }
  write_file_atomically(path, text);
}

}  // namespace mlo
