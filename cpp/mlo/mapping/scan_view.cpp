#include "mlo/mapping/scan_view.hpp"

namespace mlo {

Sight ScanView::look(const Eigen::Vector3f& p_map, bool on_ground, const FreeSpaceConfig& config) const {
  const Eigen::Vector3f from_lidar = p_map - center_map_;
  const float range_m = from_lidar.norm();
  if (range_m > static_cast<float>(config.range_m)) return Sight::unknown;
  const Eigen::Vector3f p_lidar = R_lidar_map_ * from_lidar;
  Eigen::Vector3f p_measured = p_lidar;
  if (!motion_.is_still()) {
    const auto sweep_fraction = static_cast<double>(image_.sweep_fraction(p_lidar));
    p_measured = motion_.distort(p_lidar.cast<double>(), sweep_fraction).cast<float>();
  }
  float margin_m =
      static_cast<float>(config.margin_m) + static_cast<float>(config.margin_per_range) * range_m;
  if (on_ground) margin_m += image_.step_on_ground_m(p_lidar);
  return image_.look(p_measured, margin_m);
}

}  // namespace mlo
