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
/// A plane is fitted to about so many points of a zone, evenly chosen; more cost time without changing it.
constexpr std::size_t kFitPoints = 400;
constexpr std::size_t kFitPointsNearby = 40;
/// Zones that tell the ground around the sensor end here [m].
constexpr float kNearby = 15.0F;
/// The tilt of the plane before weighs as much as points that spread so far from each other [m]. It settles
/// the tilt where points are few, close together or all on one scan line, and steadies it elsewhere.
constexpr float kPriorSpread = 0.5F;

float tan_deg(double degrees) {
  return static_cast<float>(std::tan(degrees * std::numbers::pi / 180.0));
}

float cos_deg(double degrees) {
  return static_cast<float>(std::cos(degrees * std::numbers::pi / 180.0));
}

/// Sums from which mean and covariance of points follow.
struct Moments {
  Eigen::Vector3f origin;  ///< somewhere among the points, so that single precision suffices
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

/// Plane through the points by PCA, its tilt drawn towards that of the plane before; nothing if the points
/// lie too far from it to be ground (the foot of a wall or hedge together with what is before it).
std::optional<GroundPlane> fit_plane(const Moments& moments, const GroundPlane& before,
                                     double max_roughness_m) {
  const float n = static_cast<float>(moments.count);
  const Eigen::Vector3f mean = moments.sum / n;
  const Eigen::Matrix3f covariance = moments.sum_of_squares / n - mean * mean.transpose();
  const Eigen::Matrix3f along_before =
      Eigen::Matrix3f::Identity() - before.normal * before.normal.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen(covariance +
                                                             kPriorSpread * kPriorSpread * along_before);
  if (eigen.eigenvalues()[0] > max_roughness_m * max_roughness_m) return std::nullopt;
  GroundPlane plane{.normal = eigen.eigenvectors().col(0)};
  if (plane.normal.z() < 0.0F) plane.normal = -plane.normal;
  plane.offset_m = -plane.normal.dot(moments.origin + mean);
  return plane;
}

/// Every few of the points, about `count` of them.
void append_sample(std::span<const ZonePoint> zone, std::size_t count, std::vector<Eigen::Vector3f>& sample) {
  const std::size_t step = std::max<std::size_t>(1, zone.size() / count);
  for (std::size_t i = 0; i < zone.size(); i += step) sample.push_back(zone[i].p_lidar);
}

/// The value that the given share of the values does not reach; they must not be empty.
float quantile(std::vector<float>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// Height of the lowest points within +-gate of the plane; nothing if there are too few within.
std::optional<float> lowest_height(std::span<const Eigen::Vector3f> zone, const GroundPlane& plane,
                                   float gate, std::size_t min_points) {
  std::vector<float> heights;
  heights.reserve(zone.size());
  for (const Eigen::Vector3f& p : zone) {
    const float height = plane.height(p);
    if (std::abs(height) < gate) heights.push_back(height);
  }
  if (heights.size() < min_points) return std::nullopt;
  return quantile(heights, kShareBelow);
}

/// The points from `from` to `to` above the plane; empty if they are too few for a plane.
std::optional<Moments> moments_between(std::span<const Eigen::Vector3f> zone, const GroundPlane& plane,
                                       float from, float to, std::size_t min_points) {
  if (zone.empty()) return std::nullopt;
  Moments moments{.origin = zone.front()};
  for (const Eigen::Vector3f& p : zone) {
    const float height = plane.height(p);
    if (height > from && height < to) moments.add(p);
  }
  if (moments.count < min_points) return std::nullopt;
  return moments;
}

/// Iterative PCA in one zone, begun with the points up to seed height above the lowest ones within +-gate of
/// the plane before; nothing if too few are left or they give no plane.
std::optional<GroundPlane> fit_zone(std::span<const Eigen::Vector3f> zone, const GroundPlane& before,
                                    float gate, const GroundConfig& config) {
  const auto min_points = static_cast<std::size_t>(config.min_zone_points);
  const auto distance = static_cast<float>(config.max_distance_m);
  const std::optional<float> lowest = lowest_height(zone, before, gate, min_points);
  if (!lowest) return std::nullopt;
  std::optional<Moments> inliers = moments_between(
      zone, before, *lowest - distance, *lowest + static_cast<float>(config.seed_height_m), min_points);
  double max_roughness_m = config.seed_height_m;  // seeds on a slope may still be rough
  std::optional<GroundPlane> plane;
  for (int i = 0; i <= config.iterations && inliers; ++i) {
    plane = fit_plane(*inliers, before, max_roughness_m);
    if (!plane) return std::nullopt;
    inliers = moments_between(zone, *plane, -distance, distance, min_points);
    max_roughness_m = config.max_roughness_m;
  }
  return inliers ? plane : std::nullopt;
}

/// How far the ground is known on the way outwards in a sector.
struct KnownGround {
  GroundPlane plane;
  float reached_m = 0.0F;  ///< range up to which the plane was seen
};

/// Most that the ground may rise or fall up to the border of a zone, by a step or on the way unseen [m].
float allowed_step(const KnownGround& known, float border_m, const GroundConfig& config) {
  return static_cast<float>(config.max_step_m) +
         std::max(0.0F, border_m - known.reached_m) * tan_deg(config.max_bend_deg);
}

/// May the ground go on from `before` to `plane`, seen at a point of `before` where the two zones meet?
bool continues(const GroundPlane& plane, const GroundPlane& before, const GroundPlane& nearby,
               const Eigen::Vector3f& border, float max_step_m, const GroundConfig& config) {
  return plane.normal.dot(before.normal) >= cos_deg(config.max_bend_deg) &&
         plane.normal.dot(nearby.normal) >= cos_deg(config.max_slope_deg) &&
         std::abs(plane.height(border)) <= max_step_m;
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
  std::vector<Eigen::Vector3f> sample;
  for (std::size_t sector = 0; sector < zones.num_sectors(); ++sector) {
    for (std::size_t z = 0; z < zones.num_zones() && zones.far_edge_m(z) <= kNearby; ++z) {
      append_sample(zones.points(sector, z), kFitPointsNearby, sample);
    }
  }
  const float gate = kNearby * tan_deg(config.max_slope_deg);
  const std::optional<GroundPlane> plane = fit_zone(sample, level, gate, config);
  if (plane && plane->normal.z() >= cos_deg(config.max_slope_deg)) return plane;
  return level;
}

/// Walks one sector from near to far and marks its ground points.
void segment_sector(const PolarZones& zones, std::size_t sector, const GroundPlane& nearby,
                    const GroundConfig& config, std::vector<std::uint8_t>& is_ground) {
  KnownGround known{.plane = nearby};
  std::vector<Eigen::Vector3f> sample;
  for (std::size_t z = 0; z < zones.num_zones(); ++z) {
    const std::span<const ZonePoint> zone = zones.points(sector, z);
    sample.clear();
    append_sample(zone, kFitPoints, sample);
    const Eigen::Vector2f border = zones.near_border(sector, z);
    const float max_step = allowed_step(known, border.norm(), config);
    const float gate = max_step + zones.depth_m(z) * tan_deg(config.max_bend_deg);
    const std::optional<GroundPlane> fitted = fit_zone(sample, known.plane, gate, config);
    if (fitted &&
        continues(*fitted, known.plane, nearby, onto_plane(border, known.plane), max_step, config)) {
      known = {*fitted, zones.far_edge_m(z)};
    }
    for (const ZonePoint& point : zone) {
      const float height = known.plane.height(point.p_lidar);
      is_ground[point.index] = std::abs(height) < static_cast<float>(config.max_distance_m) ? 1 : 0;
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
