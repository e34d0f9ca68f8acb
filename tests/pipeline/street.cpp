#include "pipeline/street.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mlo::test {
namespace {

constexpr double kSensorHeight_m = 1.7;
constexpr double kMaxRange_m = 80.0;

/// Distance along a ray to a block; infinite if it misses.
double distance_to(const Block& block, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Array3d a = (block.min_world - origin).array() / direction.array();
  const Eigen::Array3d b = (block.max_world - origin).array() / direction.array();
  const double enter = a.min(b).maxCoeff();
  const double leave = a.max(b).minCoeff();
  return enter > 0.0 && enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

double distance_to_street(const std::vector<Block>& blocks, const Eigen::Vector3d& origin,
                          const Eigen::Vector3d& direction) {
  double nearest =
      direction.z() < 0.0 ? -origin.z() / direction.z() : std::numeric_limits<double>::infinity();
  for (const Block& block : blocks) nearest = std::min(nearest, distance_to(block, origin, direction));
  return nearest;
}

}  // namespace

std::vector<Block> street_blocks() {
  std::vector<Block> blocks;
  for (int i = 0; i < 9; ++i) {
    const double x = -40.0 + 11.0 * i;
    const double left = 8.0 + 1.3 * (i % 3);
    const double right = -9.0 - 1.1 * (i % 4);
    blocks.push_back({{x, left, 0.0}, {x + 8.0, left + 6.0, 7.0}});
    blocks.push_back({{x + 3.0, right - 6.0, 0.0}, {x + 10.0, right, 6.0}});
    blocks.push_back({{x + 1.0, 5.9, 0.0}, {x + 1.3, 6.2, 5.0}});
    blocks.push_back({{x + 6.0, -6.3, 0.0}, {x + 6.3, -6.0, 5.0}});
  }
  blocks.push_back({{60.0, -20.0, 0.0}, {62.0, 20.0, 8.0}});
  blocks.push_back({{10.0, 2.5, 0.0}, {14.0, 4.2, 1.5}});  // the car
  return blocks;
}

SensorConfig small_lidar() {
  SensorConfig sensor;
  sensor.name = "small";
  sensor.rings = 32;
  sensor.max_elevation_deg = 8.0;
  sensor.min_elevation_deg = -23.0;
  sensor.columns = 360;
  return sensor;
}

PipelineConfig street_config() {
  PipelineConfig config;
  config.sensor = small_lidar();
  return config;
}

SE3 street_motion() {
  SE3::Tangent xi = SE3::Tangent::Zero();
  xi(0) = 0.6;
  xi(5) = 0.4 * std::numbers::pi / 180.0;
  return SE3::exp(xi);
}

SE3 street_pose(double sweeps) {
  return SE3(Eigen::Quaterniond::Identity(), {0.0, 0.0, kSensorHeight_m}) *
         interpolate(street_motion(), sweeps);
}

Scan street_scan(std::size_t frame, double sweeps, bool motion_compensated) {
  const SensorConfig sensor = small_lidar();
  const std::vector<Block> blocks = street_blocks();
  const std::vector<double> elevations_deg = sensor.elevations_deg();
  Scan scan;
  scan.frame = frame;
  scan.stamp_s = 0.1 * sweeps;
  scan.motion_compensated = motion_compensated;
  for (std::size_t ring = 0; ring < elevations_deg.size(); ++ring) {
    const double elevation = elevations_deg[ring] * std::numbers::pi / 180.0;
    for (int column = 0; column < sensor.columns; ++column) {
      const double fraction = (column + 0.5) / sensor.columns;
      const double azimuth = std::numbers::pi * (1.0 - 2.0 * fraction);
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const SE3 T_world_lidar = street_pose(sweeps + fraction - 0.5);
      const double range =
          distance_to_street(blocks, T_world_lidar.translation(), T_world_lidar.rotation() * ray);
      if (range > kMaxRange_m) continue;
      Eigen::Vector3d p = range * ray;
      if (motion_compensated) p = street_pose(sweeps).inverse() * (T_world_lidar * p);
      Point point;
      point.p_lidar = p.cast<float>();
      point.sweep_fraction = static_cast<float>(fraction);
      point.ring = static_cast<std::uint16_t>(ring);
      scan.points.push_back(point);
    }
  }
  return scan;
}

Detection parked_car(double sweeps) {
  const Block car = street_blocks().back();
  const SE3 T_lidar_world = street_pose(sweeps).inverse();
  Detection detection;
  detection.box.center_lidar_m = T_lidar_world * Eigen::Vector3d(0.5 * (car.min_world + car.max_world));
  detection.box.size_lwh_m = car.max_world - car.min_world;
  detection.box.yaw_rad = so3_log(T_lidar_world.rotation()).z();
  return detection;
}

}  // namespace mlo::test
