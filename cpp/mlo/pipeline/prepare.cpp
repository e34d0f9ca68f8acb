#include "mlo/pipeline/prepare.hpp"

#include <cmath>
#include <numbers>

#include "mlo/io/sweep_structure.hpp"

namespace mlo {
namespace {

// Azimuth within a half angle of straight ahead, by comparing cosines rather than angles.
bool is_ahead(const Eigen::Vector3f& p, float cos_half_angle) {
  return p.x() >= cos_half_angle * std::hypot(p.x(), p.y());
}

}  // namespace

Scan prepare(const Scan& scan, const SensorConfig& sensor, const InputConfig& input) {
  const auto min2 = static_cast<float>(sensor.min_range_m * sensor.min_range_m);
  const auto max2 = static_cast<float>(sensor.max_range_m * sensor.max_range_m);
  const bool crop = input.roi == RegionOfInterest::camera;
  const auto cos_half = static_cast<float>(std::cos(input.camera_half_angle_deg * std::numbers::pi / 180.0));

  Scan prepared;
  prepared.frame = scan.frame;
  prepared.stamp_s = scan.stamp_s;
  prepared.stamp_fraction = scan.stamp_fraction;
  prepared.duration_s = scan.duration_s;
  prepared.motion_compensated = scan.motion_compensated;
  prepared.points.reserve(scan.points.size());
  for (const Point& point : scan.points) {
    const float range2 = point.p_lidar.squaredNorm();
    if (!(range2 >= min2 && range2 <= max2)) continue;  // NaN fails both
    if (crop && !is_ahead(point.p_lidar, cos_half)) continue;
    prepared.points.push_back(point);
  }
  correct_vertical_angle(prepared.points, sensor.vertical_correction_deg);
  return prepared;
}

}  // namespace mlo
