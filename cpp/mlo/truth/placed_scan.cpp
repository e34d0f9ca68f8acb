#include "mlo/truth/placed_scan.hpp"

#include <iterator>
#include <limits>

#include "mlo/core/parallel.hpp"
#include "mlo/core/sweep_motion.hpp"
#include "mlo/io/sweep_structure.hpp"

namespace mlo {

PosesByFrame::PosesByFrame(const PoseList& poses) {
  for (std::size_t i = 0; i < poses.frames.size(); ++i) {
    if (poses.T_world_body[i].is_finite()) T_map_body_.emplace(poses.frames[i], poses.T_world_body[i]);
  }
}

const SE3* PosesByFrame::find(std::size_t frame) const {
  const auto found = T_map_body_.find(frame);
  return found == T_map_body_.end() ? nullptr : &found->second;
}

SE3 PosesByFrame::motion_per_sweep(std::size_t frame) const {
  const auto at = T_map_body_.find(frame);
  if (at == T_map_body_.end()) return {};
  const auto first = at == T_map_body_.begin() ? at : std::prev(at);
  const auto last = std::next(at) == T_map_body_.end() ? at : std::next(at);
  if (first == last) return {};
  const auto sweeps = static_cast<double>(last->first - first->first);
  return interpolate(first->second.inverse() * last->second, 1.0 / sweeps);
}

std::vector<Eigen::Vector3f> place_scan(const Scan& scan, const SensorConfig& sensor, const SE3& T_map_lidar,
                                        const SE3& motion_per_sweep) {
  std::vector<Point> points = scan.points;
  correct_vertical_angle(points, sensor.vertical_correction_deg);
  const SweepMotion distortion =
      scan.motion_compensated ? SweepMotion::none() : SweepMotion(motion_per_sweep, scan.stamp_fraction);
  std::vector<Eigen::Vector3f> placed(points.size(),
                                      Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  parallel_for_each_index(
      points.size(),
      [&](std::size_t i) {
        const Eigen::Vector3d p_lidar = points[i].p_lidar.cast<double>();
        const double range_m = p_lidar.norm();
        if (!(range_m >= sensor.min_range_m && range_m <= sensor.max_range_m)) return;
        const auto fraction = static_cast<double>(points[i].sweep_fraction);
        placed[i] = (T_map_lidar * distortion.undistort(p_lidar, fraction)).cast<float>();
      },
      1024);
  return placed;
}

}  // namespace mlo
