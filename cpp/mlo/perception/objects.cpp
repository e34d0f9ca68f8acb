#include "mlo/perception/objects.hpp"

#include <algorithm>
#include <numbers>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

constexpr std::size_t kGrain = 4096;

/// Upright cylinder around a box, to tell cheaply that a point is outside.
struct Circle {
  Eigen::Vector2f center;
  float squared_radius = 0.0F;
};

Circle circle_around(const Box3d& box, double margin_m) {
  constexpr double kRounding = 1e-3;  // covers that points are tested in single precision [m]
  const double radius = 0.5 * box.size_lwh_m.head<2>().norm() + std::numbers::sqrt2 * margin_m + kRounding;
  return {box.center_lidar_m.head<2>().cast<float>(), static_cast<float>(radius * radius)};
}

bool is_better(const Detection& a, const Detection& b, const Eigen::Vector3d& p_lidar) {
  if (a.confidence != b.confidence) return a.confidence > b.confidence;
  return (a.box.center_lidar_m - p_lidar).squaredNorm() < (b.box.center_lidar_m - p_lidar).squaredNorm();
}

}  // namespace

std::vector<std::uint16_t> label_objects(std::span<const Point> points, std::span<const Detection> detections,
                                         double margin_m) {
  std::vector<std::uint16_t> ids(points.size(), kNoObject);
  const std::size_t count = std::min<std::size_t>(detections.size(), kNoObject);
  if (count == 0) return ids;
  std::vector<Circle> circles;
  for (const Detection& detection : detections.first(count)) {
    circles.push_back(circle_around(detection.box, margin_m));
  }
  parallel_for_each_index(
      points.size(),
      [&](std::size_t i) {
        const Eigen::Vector3f& p = points[i].p_lidar;
        for (std::size_t k = 0; k < count; ++k) {
          if (!((p.head<2>() - circles[k].center).squaredNorm() <= circles[k].squared_radius)) continue;
          const Eigen::Vector3d p_lidar = p.cast<double>();
          if (!detections[k].box.contains(p_lidar, margin_m)) continue;
          if (ids[i] == kNoObject || is_better(detections[k], detections[ids[i]], p_lidar)) {
            ids[i] = static_cast<std::uint16_t>(k);
          }
        }
      },
      kGrain);
  return ids;
}

}  // namespace mlo
