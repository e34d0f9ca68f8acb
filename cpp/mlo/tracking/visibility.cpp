#include "mlo/tracking/visibility.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mlo/tracking/placed_box.hpp"

namespace mlo {
namespace {

/// Azimuths that a box takes, about that of its centre.
struct Sector {
  double azimuth_rad = 0.0;
  double right_rad = 0.0;  ///< <= 0
  double left_rad = 0.0;   ///< >= 0
  double range_m = 0.0;
};

Sector sector_of(const Box3d& box) {
  Sector sector;
  sector.azimuth_rad = std::atan2(box.center_lidar_m.y(), box.center_lidar_m.x());
  sector.range_m = box.center_lidar_m.head<2>().norm();
  const Eigen::Rotation2Dd rotation(box.yaw_rad);
  for (const double along : {-0.5, 0.5}) {
    for (const double across : {-0.5, 0.5}) {
      const Eigen::Vector2d corner =
          box.center_lidar_m.head<2>() +
          rotation * Eigen::Vector2d(along * box.size_lwh_m.x(), across * box.size_lwh_m.y());
      const double offset_rad = wrapped_angle(std::atan2(corner.y(), corner.x()) - sector.azimuth_rad);
      sector.right_rad = std::min(sector.right_rad, offset_rad);
      sector.left_rad = std::max(sector.left_rad, offset_rad);
    }
  }
  return sector;
}

double covered_rad(const Sector& behind, const Sector& before) {
  const double shift = wrapped_angle(before.azimuth_rad - behind.azimuth_rad);
  return std::max(0.0, std::min(behind.left_rad, before.left_rad + shift) -
                           std::max(behind.right_rad, before.right_rad + shift));
}

}  // namespace

double field_of_view_margin_rad(const Box3d& box, double field_of_view_rad) {
  if (field_of_view_rad >= 2.0 * std::numbers::pi) return std::numbers::pi;
  const Sector sector = sector_of(box);
  return 0.5 * field_of_view_rad -
         std::max(sector.azimuth_rad + sector.left_rad, -(sector.azimuth_rad + sector.right_rad));
}

std::vector<double> hidden_shares(std::span<const Box3d> boxes) {
  std::vector<Sector> sectors;
  for (const Box3d& box : boxes) sectors.push_back(sector_of(box));
  std::vector<double> shares;
  for (const Sector& behind : sectors) {
    double sum_rad = 0.0;
    for (const Sector& before : sectors) {
      if (before.range_m < behind.range_m) sum_rad += covered_rad(behind, before);
    }
    const double width_rad = behind.left_rad - behind.right_rad;
    shares.push_back(width_rad > 0.0 ? std::min(1.0, sum_rad / width_rad) : 0.0);
  }
  return shares;
}

}  // namespace mlo
