#include "mlo/perception/objects.hpp"

#include <algorithm>
#include <numbers>

#include <Eigen/Geometry>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

constexpr std::size_t kGrain = 4096;

/// Upright cylinder around a box, to tell cheaply that a point is outside.
struct Circle {
  Eigen::Vector2f center;
  float radius = 0.0F;
};

Circle circle_around(const Box3d& box, double margin_m) {
  constexpr double kRounding = 1e-3;  // covers that points are tested in single precision [m]
  const double radius = 0.5 * box.size_lwh_m.head<2>().norm() + std::numbers::sqrt2 * margin_m + kRounding;
  return {box.center_lidar_m.head<2>().cast<float>(), static_cast<float>(radius)};
}

// Which circles may hold a point, by squares seen from above.
class CircleGrid {
 public:
  /// What is not finite, or larger than any world, holds nothing.
  explicit CircleGrid(std::span<const Circle> circles) {
    Eigen::AlignedBox2f bounds;
    for (const Circle& circle : circles) {
      if (!is_usable(circle)) continue;
      const Eigen::Vector2f reach = Eigen::Vector2f::Constant(circle.radius);
      bounds.extend(Eigen::AlignedBox2f(circle.center - reach, circle.center + reach));
    }
    if (bounds.isEmpty()) return;
    low_ = bounds.min().array();
    inverse_side_ = 1.0F / std::max(kSideM, bounds.sizes().maxCoeff() / kMostAcross);
    across_ = cell_of(bounds.max()) + 1;
    cells_.resize(static_cast<std::size_t>(across_.prod()));
    for (std::size_t k = 0; k < circles.size(); ++k) {
      if (is_usable(circles[k])) add(circles[k], static_cast<std::uint16_t>(k));
    }
  }

  /// Indices, growing.
  std::span<const std::uint16_t> near(const Eigen::Vector2f& p) const {
    if (!((p.array() >= low_).all() && ((p.array() - low_) * inverse_side_ < across_.cast<float>()).all())) {
      return {};
    }
    const Eigen::Array2i cell = cell_of(p);
    return cells_[index(cell.x(), cell.y())];
  }

 private:
  static constexpr float kSideM = 2.0F;
  static constexpr float kMostAcross = 256.0F;
  static constexpr float kLargestM = 1e6F;

  static bool is_usable(const Circle& circle) {
    return circle.center.allFinite() && circle.center.norm() < kLargestM && circle.radius < kLargestM;
  }
  Eigen::Array2i cell_of(const Eigen::Vector2f& p) const {
    return ((p.array() - low_) * inverse_side_).cast<int>();
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(across_.x()) + static_cast<std::size_t>(x);
  }
  void add(const Circle& circle, std::uint16_t k) {
    const Eigen::Vector2f reach = Eigen::Vector2f::Constant(circle.radius);
    const Eigen::Array2i first = cell_of(circle.center - reach);
    const Eigen::Array2i last = cell_of(circle.center + reach).min(across_ - 1);
    for (int y = first.y(); y <= last.y(); ++y) {
      for (int x = first.x(); x <= last.x(); ++x) cells_[index(x, y)].push_back(k);
    }
  }

  Eigen::Array2f low_ = Eigen::Array2f::Zero();
  float inverse_side_ = 0.0F;
  Eigen::Array2i across_ = Eigen::Array2i::Zero();
  std::vector<std::vector<std::uint16_t>> cells_;
};

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
  const CircleGrid grid(circles);
  parallel_for_each_index(
      points.size(),
      [&](std::size_t i) {
        const Eigen::Vector3f& p = points[i].p_lidar;
        for (const std::uint16_t k : grid.near(p.head<2>())) {
          const float radius = circles[k].radius;
          if (!((p.head<2>() - circles[k].center).squaredNorm() <= radius * radius)) continue;
          const Eigen::Vector3d p_lidar = p.cast<double>();
          if (!detections[k].box.contains(p_lidar, margin_m)) continue;
          if (ids[i] == kNoObject || is_better(detections[k], detections[ids[i]], p_lidar)) {
            ids[i] = k;
          }
        }
      },
      kGrain);
  return ids;
}

}  // namespace mlo
