#include "mlo/io/trajectory_file.hpp"

#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/text_table.hpp"

namespace mlo {
namespace {

constexpr std::size_t kKittiFields = 12;
constexpr std::size_t kTumFields = 8;
// Files with few digits are off by 1e-3; anything beyond this is not a rotation at all.
constexpr double kRotationTolerance = 1e-2;

SE3 kitti_pose(const TextRow& row) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (std::size_t i = 0; i < kKittiFields; ++i) {
    matrix(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = row.number(i);
  }
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const bool orthogonal = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < kRotationTolerance;
  if (!orthogonal || R.determinant() < 0.0) {
    row.fail("the 3x3 part is not a rotation; expected KITTI rows r11 r12 r13 tx r21 ...");
  }
  return SE3::from_matrix(matrix);
}

SE3 tum_pose(const TextRow& row) {
  const Eigen::Quaterniond q(row.number(7), row.number(4), row.number(5), row.number(6));
  if (std::abs(q.norm() - 1.0) > kRotationTolerance) {
    row.fail("the quaternion does not have length 1; expected TUM rows stamp tx ty tz qx qy qz qw");
  }
  return {q, {row.number(1), row.number(2), row.number(3)}};
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file)
    throw InputError(fmt::format("{}: cannot be written; check folder, rights and space", path.string()));
}

}  // namespace

PoseList read_trajectory(const std::filesystem::path& path) {
  const TextTable table(path);
  PoseList poses;
  for (const TextRow& row : table.rows()) {
    const std::size_t expected = table.rows().front().size();
    if (row.size() != expected || (expected != kKittiFields && expected != kTumFields)) {
      row.fail(
          fmt::format("{} values; expected 12 in every row (KITTI) or 8 in every row (TUM)", row.size()));
    }
    poses.frames.push_back(poses.frames.size());
    if (expected == kTumFields) poses.stamps_s.push_back(row.number(0));
    poses.T_world_body.push_back(expected == kTumFields ? tum_pose(row) : kitti_pose(row));
  }
  return poses;
}

void write_kitti_poses(const std::filesystem::path& path, const PoseList& poses) {
  std::string text;
  for (const SE3& pose : poses.T_world_body) {
    const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = pose.matrix().topRows<3>();
    fmt::format_to(std::back_inserter(text), "{}\n", fmt::join(rows.data(), rows.data() + rows.size(), " "));
  }
  write_text(path, text);
}

void write_tum_poses(const std::filesystem::path& path, const PoseList& poses) {
  if (poses.stamps_s.size() != poses.T_world_body.size()) {
    throw InputError(
        fmt::format("{}: TUM rows need a stamp for every pose, but there are {} stamps and {} poses",
                    path.string(), poses.stamps_s.size(), poses.T_world_body.size()));
  }
  std::string text;
  for (std::size_t i = 0; i < poses.T_world_body.size(); ++i) {
    const Eigen::Vector3d& t = poses.T_world_body[i].translation();
    Eigen::Quaterniond q = poses.T_world_body[i].rotation();
    if (q.w() < 0.0) q.coeffs() *= -1.0;
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {} {}\n", poses.stamps_s[i], t.x(), t.y(),
                   t.z(), q.x(), q.y(), q.z(), q.w());
  }
  write_text(path, text);
}

}  // namespace mlo
