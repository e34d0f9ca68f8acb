#include "mlo/io/scan_files.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/sweep_structure.hpp"
#include "mlo/io/text.hpp"
#include "mlo/io/velodyne_bin.hpp"

namespace mlo {
namespace {

PointCloudFile read_points(const std::filesystem::path& file) {
  if (to_lower(file.extension().string()) == ".bin") return read_velodyne_bin(file);
  return read_point_cloud(file);
}

// Sweep fractions, duration and stamp from the points' own times [s]; false if these do not differ. Times
// that span or touch zero count from the scan's stamp. Others are on a clock of their own: the stamp is taken
// if it lies in the sweep, else the middle of the sweep becomes the stamp.
bool set_times(Scan& scan, const std::vector<double>& times_s) {
  if (times_s.empty()) return false;
  const auto [first, last] = std::minmax_element(times_s.begin(), times_s.end());
  const double start_s = *first;
  const double end_s = *last;
  const double duration_s = end_s - start_s;
  if (!(duration_s > 0.0)) return false;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    scan.points[i].sweep_fraction = static_cast<float>((times_s[i] - start_s) / duration_s);
  }
  const bool from_stamp = start_s - duration_s <= 0.0 && end_s + duration_s >= 0.0;
  const bool stamp_inside = scan.stamp_s >= start_s && scan.stamp_s <= end_s;
  double stamp_in_sweep_s = stamp_inside ? scan.stamp_s : 0.5 * (start_s + end_s);
  if (from_stamp) stamp_in_sweep_s = std::clamp(0.0, start_s, end_s);
  scan.stamp_s = from_stamp ? scan.stamp_s + stamp_in_sweep_s : stamp_in_sweep_s;
  scan.stamp_fraction = (stamp_in_sweep_s - start_s) / duration_s;
  scan.duration_s = duration_s;
  return true;
}

// Some drivers write a point at the origin where there was no return. Returns how many were taken out.
std::size_t drop_points_at_origin(PointCloudFile& content) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < content.points.size(); ++i) {
    if (content.points[i].p_lidar.isZero(0.0F)) continue;
    content.points[kept] = content.points[i];
    if (!content.times_s.empty()) content.times_s[kept] = content.times_s[i];
    ++kept;
  }
  const std::size_t dropped = content.points.size() - kept;
  content.points.resize(kept);
  if (!content.times_s.empty()) content.times_s.resize(kept);
  return dropped;
}

}  // namespace

ScanFiles::ScanFiles(std::vector<ScanFile> files, ScanFileTraits traits)
    : files_(std::move(files)), traits_(std::move(traits)) {}

ScanReading ScanFiles::read(std::size_t index) const {
  const ScanFile& file = files_.at(index);
  ScanReading reading;
  if (!std::filesystem::exists(file.path)) {
    reading.missing = true;
    reading.problem = fmt::format("{}: the scan is missing", file.path.string());
    return reading;
  }
  try {
    PointCloudFile content = read_points(file.path);
    reading.invalid_points = content.invalid_points + drop_points_at_origin(content);
    if (content.points.empty()) {
      reading.problem = fmt::format("{}: no valid point ({} are NaN, infinite or at the origin)",
                                    file.path.string(), reading.invalid_points);
      return reading;
    }
    Scan scan{.points = std::move(content.points),
              .frame = file.frame,
              .stamp_s = file.stamp_s,
              .stamp_fraction = traits_.stamp_fraction,
              .duration_s = file.duration_s,
              .motion_compensated = traits_.motion_compensated};
    if (!(content.has_ring && order_rings(scan.points, traits_.sensor))) {
      recover_rings(scan.points, traits_.sensor);
    }
    if (!set_times(scan, content.times_s)) recover_sweep_fractions(scan.points, traits_.sensor);
    reading.scan = std::move(scan);
  } catch (const InputError& error) {
    reading.problem = error.what();
  }
  return reading;
}

}  // namespace mlo
