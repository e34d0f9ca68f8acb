#include "mlo/perception/ground.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Eigenvalues>

#include "mlo/core/parallel.hpp"
#include "mlo/perception/polar_zones.hpp"

namespace mlo {
namespace {

/// Share of a zone's points that may lie below the ground (multipath): its lowest point representative (LPR)
/// is the height that so many of them do not reach.
constexpr double kShareBelow = 0.05;
constexpr double kShareBelowNearby = 0.2;
/// Zones that tell the ground around the sensor end here [m].
constexpr float kNearby = 15.0F;
/// Ground points must spread this much across their main direction to tilt a plane [m]; less is one scan
/// line.
constexpr float kMinSpread = 0.3F;

float tan_deg(double degrees) {
  return static_cast<float>(std::tan(degrees * std::numbers::pi / 180.0));
}

float cos_deg(double degrees) {
  return static_cast<float>(std::cos(degrees * std::numbers::pi / 180.0));
}

/// Sums from which mean and covariance of points near `origin` follow.
struct Moments {
  Eigen::Vector3f origin;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f sum_of_squares = Eigen::Matrix3f::Zero();
  std::size_t count = 0;

  void add(const Eigen::Vector3f& p) {
    const Eigen::Vector3f d = p - origin;
    sum += d;
    sum_of_squares += d * d.transpose();
    ++count;
  }
};

/// Plane through the points by PCA. Points along one line leave its tilt open: then that of `prior` is kept.
GroundPlane fit_plane(const Moments& moments, const GroundPlane& prior) {
  const float n = static_cast<float>(moments.count);
  const Eigen::Vector3f offset = moments.sum / n;
  const Eigen::Matrix3f covariance = moments.sum_of_squares / n - offset * offset.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen(covariance);
  GroundPlane plane = prior;
  if (eigen.eigenvalues()[1] > kMinSpread * kMinSpread) {
    plane.normal = eigen.eigenvectors().col(0);
    if (plane.normal.z() < 0.0F) plane.normal = -plane.normal;
  }
  plane.offset_m = -plane.normal.dot(moments.origin + offset);
  return plane;
}

/// The value that the given share of the values does not reach; they must not be empty.
float quantile(std::vector<float>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// Height of the lowest points within +-gate of the plane; nothing if there are too few within.
std::optional<float> lowest_height(std::span<const ZonePoint> zone, const GroundPlane& plane, float gate,
                                   std::size_t min_points) {
  std::vector<float> heights;
  heights.reserve(zone.size());
  for (const ZonePoint& point : zone) {
    const float height = plane.height(point.p_lidar);
    if (std::abs(height) < gate) heights.push_back(height);
  }
  if (heights.size() < min_points) return std::nullopt;
  return quantile(heights, kShareBelow);
}

/// Iterative PCA in one zone, begun with the points up to seed height above the lowest ones within +-gate of
/// the prior; nothing if too few are left.
std::optional<GroundPlane> fit_zone(std::span<const ZonePoint> zone, const GroundPlane& prior, float gate,
                                    const GroundConfig& config) {
  const auto min_points = static_cast<std::size_t>(config.min_zone_points);
  const auto max_distance = static_cast<float>(config.max_distance_m);
  const std::optional<float> lowest = lowest_height(zone, prior, gate, min_points);
  if (!lowest) return std::nullopt;
  GroundPlane plane = prior;
  float from = *lowest - max_distance;
  float to = *lowest + static_cast<float>(config.seed_height_m);
  for (int i = 0; i <= config.iterations; ++i) {
    Moments moments{.origin = zone.front().p_lidar};
    for (const ZonePoint& point : zone) {
      const float height = plane.height(point.p_lidar);
      if (height > from && height < to) moments.add(point.p_lidar);
    }
    if (moments.count < min_points) return std::nullopt;
    plane = fit_plane(moments, prior);
    from = -max_distance;
    to = max_distance;
  }
  return plane;
}

/// The gate around the expected ground that lets a zone bend and step by what is allowed.
float gate_of(float depth, const GroundConfig& config) {
  return static_cast<float>(config.max_step_m) + depth * tan_deg(config.max_bend_deg);
}

/// May the ground go on from `before` to `plane`, seen at a point of `before` where the two zones meet?
bool continues(const GroundPlane& plane, const GroundPlane& before, const GroundPlane& nearby,
               const Eigen::Vector3f& border, const GroundConfig& config) {
  return plane.normal.dot(before.normal) >= cos_deg(config.max_bend_deg) &&
         plane.normal.dot(nearby.normal) >= cos_deg(config.max_slope_deg) &&
         std::abs(plane.height(border)) <= static_cast<float>(config.max_step_m);
}

/// The point of the plane above or below a place on the level.
Eigen::Vector3f onto_plane(const Eigen::Vector2f& place, const GroundPlane& plane) {
  const float z = -(plane.normal.head<2>().dot(place) + plane.offset_m) / plane.normal.z();
  return {place.x(), place.y(), z};
}

/// Height of the ground beneath the sensor: median over the zones around it of their low points, below the
/// sensor. Zones with multipath or without sight of the ground do not matter while they are fewer than half.
std::optional<float> nearby_height(const PolarZones& zones, const GroundConfig& config) {
  std::vector<float> lowest;
  std::vector<float> heights;
  for (std::size_t sector = 0; sector < zones.num_sectors(); ++sector) {
    for (std::size_t z = 0; z < zones.num_zones() && zones.far_edge_m(z) <= kNearby; ++z) {
      heights.clear();
      for (const ZonePoint& point : zones.points(sector, z)) heights.push_back(point.p_lidar.z());
      if (heights.size() < static_cast<std::size_t>(config.min_zone_points)) continue;
      const float low = quantile(heights, kShareBelowNearby);
      if (low < 0.0F) lowest.push_back(low);
    }
  }
  if (lowest.empty()) return std::nullopt;
  return quantile(lowest, 0.5);
}

/// Plane of the ground around the sensor, fitted to the near zones of all sectors together.
std::optional<GroundPlane> fit_nearby(const PolarZones& zones, const GroundConfig& config) {
  const std::optional<float> height = nearby_height(zones, config);
  if (!height) return std::nullopt;
  const GroundPlane level{.offset_m = -*height};
  std::vector<ZonePoint> near_points;
  for (std::size_t sector = 0; sector < zones.num_sectors(); ++sector) {
    for (std::size_t z = 0; z < zones.num_zones() && zones.far_edge_m(z) <= kNearby; ++z) {
      const std::span<const ZonePoint> zone = zones.points(sector, z);
      near_points.insert(near_points.end(), zone.begin(), zone.end());
    }
  }
  if (near_points.empty()) return level;
  const float gate = gate_of(kNearby, config);
  const std::optional<GroundPlane> plane = fit_zone(near_points, level, gate, config);
  if (plane && plane->normal.z() >= cos_deg(config.max_slope_deg)) return plane;
  return level;
}

/// Walks one sector from near to far and marks its ground points.
void segment_sector(const PolarZones& zones, std::size_t sector, const GroundPlane& nearby,
                    const GroundConfig& config, std::vector<std::uint8_t>& is_ground) {
  GroundPlane plane = nearby;
  for (std::size_t z = 0; z < zones.num_zones(); ++z) {
    const std::span<const ZonePoint> zone = zones.points(sector, z);
    if (zone.empty()) continue;
    const std::optional<GroundPlane> fitted =
        fit_zone(zone, plane, gate_of(zones.depth_m(z), config), config);
    const Eigen::Vector3f border = onto_plane(zones.near_border(sector, z), plane);
    if (fitted && continues(*fitted, plane, nearby, border, config)) plane = *fitted;
    for (const ZonePoint& point : zone) {
      const bool near_plane =
          std::abs(plane.height(point.p_lidar)) < static_cast<float>(config.max_distance_m);
      is_ground[point.index] = near_plane ? 1 : 0;
    }
  }
}

}  // namespace

GroundSegmentation segment_ground(std::span<const Point> points, const GroundConfig& config) {
  GroundSegmentation result;
  result.is_ground.assign(points.size(), 0);
  const PolarZones zones(points, config);
  const std::optional<GroundPlane> nearby = fit_nearby(zones, config);
  if (!nearby) return result;
  result.nearby = *nearby;
  result.found = true;
  parallel_for_each_index(zones.num_sectors(), [&](std::size_t sector) {
    segment_sector(zones, sector, *nearby, config, result.is_ground);
  });
  return result;
}

}  // namespace mlo
