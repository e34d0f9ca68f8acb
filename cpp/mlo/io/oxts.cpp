#include "mlo/io/oxts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/sequence_files.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

constexpr double kDegToRad = std::numbers::pi / 180.0;

OxtsRecord parse_oxts(const std::string& line, const std::string& where) {
  constexpr std::size_t kPoseFields = 6;
  constexpr std::size_t kMotionFields = 25;
  const std::vector<double> v = parse_numbers(line, where);
  if (v.size() < kPoseFields) {
    throw InputError(fmt::format("{}: {} numbers, an oxts record has 30", where, v.size()));
  }
  OxtsRecord record;
  record.latitude_deg = v[0];
  record.longitude_deg = v[1];
  record.altitude_m = v[2];
  record.roll_pitch_yaw_rad = {v[3], v[4], v[5]};
  if (v.size() < kMotionFields) return record;
  record.motion = OxtsRecord::Motion{.velocity_enu_m_s = {v[7], v[6], v[10]},
                                     .rate_imu_rad_s = {v[17], v[18], v[19]},
                                     .position_accuracy_m = v[23],
                                     .velocity_accuracy_m_s = v[24]};
  return record;
}

}  // namespace

std::vector<OxtsRecord> read_oxts_file(const fs::path& file) {
  const std::vector<std::string> lines = read_lines(file);
  std::vector<OxtsRecord> records;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    records.push_back(parse_oxts(lines[i], fmt::format("{}:{}", file.string(), i + 1)));
    records.back().frame = i;
  }
  return records;
}

std::vector<OxtsRecord> read_oxts_records(const fs::path& folder) {
  std::vector<double> stamps_s;
  if (const fs::path file = folder / "timestamps.txt"; fs::exists(file)) stamps_s = read_stamps_s(file);
  std::vector<OxtsRecord> records;
  for (const ScanFile& entry : list_numbered_scans(folder / "data", ".txt")) {
    if (!fs::exists(entry.path)) continue;
    const std::vector<std::string> lines = read_lines(entry.path);
    if (lines.empty())
      throw InputError(fmt::format("{}: empty, an oxts record is needed", entry.path.string()));
    records.push_back(parse_oxts(lines.front(), fmt::format("{}:1", entry.path.string())));
    records.back().frame = entry.frame;
  }
  const bool all_known = std::all_of(records.begin(), records.end(), [&](const OxtsRecord& record) {
    return record.frame < stamps_s.size() && std::isfinite(stamps_s[record.frame]);
  });
  if (!all_known) return records;
  for (OxtsRecord& record : records) record.stamp_s = stamps_s[record.frame];
  return records;
}

std::vector<SE3> oxts_poses(std::span<const OxtsRecord> records) {
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

}  // namespace mlo
