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
/// is the height that so many of them do not reach. More where no plane before tells what is too low.
constexpr double kShareBelow = 0.05;
constexpr double kShareBelowNearby = 0.2;
/// A plane is fitted to about so many points of a zone, evenly chosen; more cost time without changing it.
constexpr std::size_t kFitPoints = 400;
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
  float xx = 0.0F, xy = 0.0F, xz = 0.0F, yy = 0.0F, yz = 0.0F, zz = 0.0F;  ///< sums of products
  std::size_t count = 0;

  void add(const Eigen::Vector3f& p) {
    const Eigen::Vector3f d = p - origin;
    sum += d;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    xz += d.x() * d.z();
    yy += d.y() * d.y();
    yz += d.y() * d.z();
    zz += d.z() * d.z();
    ++count;
  }
  Eigen::Matrix3f covariance() const {
    const auto n = static_cast<float>(count);
    Eigen::Matrix3f products;
    products << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return products / n - (sum / n) * (sum / n).transpose();
  }
};

/// Plane through the points by PCA, its tilt drawn towards that of the plane before.
GroundPlane fit_plane(const Moments& moments, const GroundPlane& before) {
  const Eigen::Vector3f mean = moments.sum / static_cast<float>(moments.count);
  const Eigen::Matrix3f along_before =
      Eigen::Matrix3f::Identity() - before.normal * before.normal.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen(moments.covariance() +
                                                             kPriorSpread * kPriorSpread * along_before);
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
  for (int i = 0; i < config.iterations && inliers; ++i) {
    inliers = moments_between(zone, fit_plane(*inliers, before), -distance, distance, min_points);
  }
  if (!inliers) return std::nullopt;
  const GroundPlane plane = fit_plane(*inliers, before);
  // A plane that cuts through the foot of a wall or hedge and what is before it has its points far off.
  const float variance = plane.normal.dot(inliers->covariance() * plane.normal);
  if (variance > config.max_roughness_m * config.max_roughness_m) return std::nullopt;
  return plane;
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

/// A low point of each zone around the sensor: most of them lie on the ground, some on what hides it, some
/// below (multipath).
std::vector<Eigen::Vector3f> low_points(const PolarZones& zones) {
  const auto is_lower = [](const ZonePoint& a, const ZonePoint& b) { return a.p_lidar.z() < b.p_lidar.z(); };
  std::vector<Eigen::Vector3f> low;
  std::vector<ZonePoint> zone;
  for (std::size_t sector = 0; sector < zones.num_sectors(); ++sector) {
    for (std::size_t z = 0; z < zones.num_zones() && zones.near_edge_m(z) < kNearby; ++z) {
      const std::span<const ZonePoint> points = zones.points(sector, z);
      if (points.empty()) continue;
      zone.assign(points.begin(), points.end());
      const auto at = zone.begin() +
                      static_cast<std::ptrdiff_t>(kShareBelowNearby * static_cast<double>(zone.size() - 1));
      std::nth_element(zone.begin(), at, zone.end(), is_lower);
      low.push_back(at->p_lidar);
    }
  }
  return low;
}

/// Plane of the ground around the sensor: least trimmed squares of the low points, by concentration steps
/// (Rousseeuw and van Driessen, 2006) from the level plane at their median height. Nothing if no ground lies
/// below the sensor.
std::optional<GroundPlane> fit_nearby(const PolarZones& zones, const GroundConfig& config) {
  constexpr double kShareOnGround = 0.6;
  constexpr int kSteps = 10;
  std::vector<Eigen::Vector3f> points = low_points(zones);
  if (points.empty()) return std::nullopt;
  std::vector<float> heights;
  for (const Eigen::Vector3f& p : points) heights.push_back(p.z());
  const GroundPlane level{.offset_m = -quantile(heights, 0.5)};
  GroundPlane plane = level;
  const auto on_ground =
      static_cast<std::ptrdiff_t>(kShareOnGround * static_cast<double>(points.size() - 1)) + 1;
  for (int i = 0; i < kSteps; ++i) {
    std::nth_element(points.begin(), points.begin() + on_ground - 1, points.end(),
                     [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
                       return std::abs(plane.height(a)) < std::abs(plane.height(b));
                     });
    Moments moments{.origin = points.front()};
    std::for_each(points.begin(), points.begin() + on_ground,
                  [&](const Eigen::Vector3f& p) { moments.add(p); });
    plane = fit_plane(moments, level);
  }
  if (plane.normal.z() < cos_deg(config.max_slope_deg)) plane = level;
  if (plane.offset_m <= 0.0F) return std::nullopt;
  return plane;
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
