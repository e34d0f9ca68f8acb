#include "mlo/detection/network_input.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mlo/core/point_budget.hpp"
#include "mlo/core/random.hpp"

namespace mlo {
namespace {

constexpr std::uint64_t kShuffleSeed = 17;

}  // namespace

std::vector<Point> network_points(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                                  const NetworkFrame& frame, const NetworkInputSpec& spec) {
  const auto max_range_m = static_cast<float>(spec.max_range_m);
  const auto half_angle_rad = static_cast<float>(spec.half_angle_deg * std::numbers::pi / 180.0);
  std::vector<Point> taken;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_ground[i] != 0 && !spec.keeps_ground) continue;
    Point point = points[i];
    const Eigen::Vector2f p = point.p_lidar.head<2>();
    if (p.norm() >= max_range_m || std::abs(std::atan2(p.y(), p.x())) > half_angle_rad) continue;
    point.p_lidar.z() +=
        static_cast<float>(frame.shift_at(static_cast<double>(p.x()), static_cast<double>(p.y())));
    const double height_m = static_cast<double>(point.p_lidar.z()) + spec.sensor_height_m;
    if (height_m >= spec.min_height_m && height_m <= spec.max_height_m) taken.push_back(point);
  }
  taken = thin_points(taken, static_cast<std::size_t>(spec.max_points));
  shuffle(taken, kShuffleSeed);
  return taken;
}

NetworkInput network_input(std::span<const Point> points, const NetworkInputSpec& spec) {
  const auto count = static_cast<Eigen::Index>(points.size());
  NetworkInput input{PointRows(count, 3), RowMatrix(count, static_cast<Eigen::Index>(spec.features.size()))};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Point& point = points[static_cast<std::size_t>(i)];
    input.points.row(i) = point.p_lidar.transpose();
    for (std::size_t f = 0; f < spec.features.size(); ++f) {
      input.features(i, static_cast<Eigen::Index>(f)) =
          spec.features[f] == PointFeature::intensity
              ? point.intensity
              : point.p_lidar.z() + static_cast<float>(spec.sensor_height_m);
    }
  }
  return input;
}

}  // namespace mlo
