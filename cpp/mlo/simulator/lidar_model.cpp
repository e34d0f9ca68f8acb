#include "mlo/simulator/lidar_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "mlo/core/parallel.hpp"
#include "mlo/simulator/surfaces.hpp"

namespace mlo::simulator {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Parts of the robot around and below the lidar, in the lidar frame: they explain the gaps in the lowest
/// rings of KITTI's scans.
struct RoofPart {
  double x_min, x_max, y_min, y_max;
};
constexpr double kRoofBelow_m = 0.27;
constexpr std::array kRoof{RoofPart{-0.78, -0.30, -0.32, 0.32},  RoofPart{-1.10, -0.75, 0.33, 0.46},
                           RoofPart{-1.10, -0.75, -0.50, -0.36}, RoofPart{0.10, 0.36, -0.82, -0.50},
                           RoofPart{0.50, 0.72, -0.22, 0.22},    RoofPart{-0.60, -0.42, 0.42, 0.62}};

bool hits_own_roof(const Eigen::Vector3d& direction_lidar) {
  if (direction_lidar.z() >= 0.0) return false;
  const Eigen::Vector3d p = direction_lidar * (-kRoofBelow_m / direction_lidar.z());
  return std::ranges::any_of(kRoof, [&](const RoofPart& part) {
    return p.x() > part.x_min && p.x() < part.x_max && p.y() > part.y_min && p.y() < part.y_max;
  });
}

/// Share of the light that comes back, relative to a white wall at 60 m.
double signal(double reflectance, double cos_incidence, double range_m) {
  constexpr double kReference_m = 60.0;
  constexpr double kRough = 0.15;  // surfaces are never seen at zero incidence all over
  const double falloff = kReference_m / std::max(range_m, 1.0);
  return reflectance * (kRough + (1.0 - kRough) * cos_incidence) * falloff * falloff;
}

/// Paint differs from car to car, clothes from person to person.
double reflectance_of(const RayHit& hit, std::uint64_t seed) {
  const double base = optics(hit.surface).reflectance;
  const bool varies = hit.surface == Surface::paint || hit.surface == Surface::cloth;
  if (!varies) return base;
  return base * Random(mix(seed, static_cast<std::uint64_t>(hit.object_id))).uniform(0.2, 1.7);
}

bool is_lost(const RayHit& hit, double level, const LidarErrors& errors, Random& random) {
  constexpr double kSharpness = 3.0;
  const double p_weak =
      errors.loss_level > 0.0 ? 1.0 / (1.0 + std::pow(level / errors.loss_level, kSharpness)) : 0.0;
  const double mirrored = errors.loss_level > 0.0 ? optics(hit.surface).loss : 0.0;
  return random.chance(errors.random_loss) || random.chance(mirrored) || random.chance(p_weak);
}

/// Full reflectance above one level of the signal, nothing below another: far road is black, as in KITTI's
/// scans.
float intensity(double reflectance, double level, Random& random) {
  constexpr double kBlack = 0.10;
  constexpr double kFull = 0.40;
  constexpr double kGrain = 0.08;  // standard deviation from place to place
  const double share = std::clamp((level - kBlack) / (kFull - kBlack), 0.0, 1.0);
  const double value = reflectance * share + kGrain * random.normal();
  return static_cast<float>(std::round(100.0 * std::clamp(value, 0.0, 0.99)) / 100.0);
}

Eigen::Vector3d direction(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::sin(elevation_rad)};
}

/// Azimuth of a column in [0, 2 pi).
double column_azimuth(const SensorConfig& sensor, int column) {
  const double turn = (column + 0.5) / sensor.columns * (sensor.clockwise ? -360.0 : 360.0);
  const double degrees = std::fmod(sensor.start_azimuth_deg + turn, 360.0);
  return (degrees < 0.0 ? degrees + 360.0 : degrees) * kDegree;
}

struct Caster {
  const RayWorld& world;
  const LidarErrors& errors;
  std::uint64_t sweep_seed, scene_seed;

  /// @param ray  number of the ray in its sweep: its random numbers depend on nothing else
  std::optional<SimulatedPoint> cast(const SE3& T_world_lidar, double azimuth_rad, double elevation_rad,
                                     double fraction, std::uint64_t ray, double min_range_m) const {
    const Eigen::Vector3d beam_lidar = direction(azimuth_rad, elevation_rad);
    if (errors.own_roof && hits_own_roof(beam_lidar)) return std::nullopt;
    const Eigen::Vector3d beam_world = T_world_lidar.rotation() * beam_lidar;
    const std::optional<RayHit> hit =
        world.cast(T_world_lidar.translation(), beam_world, fraction, errors.max_range_m);
    if (!hit || hit->range_m < min_range_m) return std::nullopt;
    Random random(mix(sweep_seed, ray));
    const double reflectance = reflectance_of(*hit, scene_seed);
    const double level = signal(reflectance, hit->cos_incidence, hit->range_m);
    if (is_lost(*hit, level, errors, random)) return std::nullopt;
    const double range = hit->range_m + errors.range_noise_m * random.normal();
    SimulatedPoint point;
    const Eigen::Vector3d reported =
        direction(azimuth_rad, elevation_rad - errors.elevation_bias_deg * kDegree);
    point.measured.p_lidar = (range * reported).cast<float>();
    point.measured.intensity = intensity(reflectance, level, random);
    point.measured.sweep_fraction = static_cast<float>(fraction);
    point.p_world = (T_world_lidar.translation() + hit->range_m * beam_world).cast<float>();
    point.surface = hit->surface;
    point.object_id = hit->object_id;
    return point;
  }
};

/// Columns in the order of growing azimuth from ahead.
std::vector<int> columns_from_ahead(const SensorConfig& sensor) {
  std::vector<int> order(static_cast<std::size_t>(sensor.columns));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](int column) { return column_azimuth(sensor, column); });
  return order;
}

}  // namespace

double stamp_fraction(const SensorConfig& sensor) {
  const double turn = (sensor.clockwise ? 1.0 : -1.0) * sensor.start_azimuth_deg / 360.0;
  return turn - std::floor(turn);
}

Sweep scan(const Scene& scene, RayWorld& world, const SensorConfig& sensor, const LidarErrors& errors,
           double start_s, std::uint64_t frame, std::uint64_t seed) {
  const double duration_s = 1.0 / sensor.rate_hz;
  Sweep sweep{start_s, start_s + stamp_fraction(sensor) * duration_s, start_s + duration_s, {}};
  const SE3 T_world_stamp = scene.robot.T_world_lidar(scene.terrain, sweep.stamp_s);
  world.set_sweep(sweep.start_s, sweep.end_s, T_world_stamp.translation(), errors.max_range_m);

  const std::vector<double> elevations_deg = sensor.elevations_deg();
  const std::size_t rings = elevations_deg.size();
  const auto columns = static_cast<std::size_t>(sensor.columns);
  const Caster caster{world, errors, mix(mix(seed, 0x11DA), frame), seed};
  std::vector<std::optional<SimulatedPoint>> grid(rings * columns);
  parallel_for_each_index(
      columns,
      [&](std::size_t column) {
        const double fraction = (static_cast<double>(column) + 0.5) / static_cast<double>(columns);
        const SE3 T_world_lidar = scene.robot.T_world_lidar(scene.terrain, start_s + fraction * duration_s);
        const double azimuth = column_azimuth(sensor, static_cast<int>(column));
        for (std::size_t ring = 0; ring < rings; ++ring) {
          const std::size_t ray = ring * columns + column;
          grid[ray] = caster.cast(T_world_lidar, azimuth, elevations_deg[ring] * kDegree, fraction, ray,
                                  sensor.min_range_m);
          if (grid[ray]) grid[ray]->measured.ring = static_cast<std::uint16_t>(ring);
        }
      },
      16);
  const std::vector<int> order = columns_from_ahead(sensor);
  for (std::size_t ring = 0; ring < rings; ++ring) {
    for (const int column : order) {
      const std::optional<SimulatedPoint>& point = grid[ring * columns + static_cast<std::size_t>(column)];
      if (point) sweep.points.push_back(*point);
    }
  }
  return sweep;
}

}  // namespace mlo::simulator
