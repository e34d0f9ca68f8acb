#include "mlo/simulator/oxts.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace mlo::simulator {
namespace {

constexpr double kEarthRadius_m = 6378137.0;
constexpr double kLatitude_deg = 49.0;
constexpr double kLongitude_deg = 8.4;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kGravity_mps2 = 9.81;

struct Geographic {
  double latitude_deg, longitude_deg;
};

Geographic geographic(double east_m, double north_m) {
  const double scale = std::cos(kLatitude_deg * kRadPerDeg) * kEarthRadius_m;
  const double origin_north = std::log(std::tan(0.25 * std::numbers::pi + 0.5 * kLatitude_deg * kRadPerDeg));
  const double mercator_north = north_m / scale + origin_north;
  return {(2.0 * std::atan(std::exp(mercator_north)) - 0.5 * std::numbers::pi) / kRadPerDeg,
          kLongitude_deg + east_m / scale / kRadPerDeg};
}

}  // namespace

std::string oxts_line(const ImuPoses& poses) {
  const SE3& pose = poses.T_world_imu;
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Vector3d before = poses.T_world_imu_before.translation();
  const Eigen::Vector3d after = poses.T_world_imu_after.translation();
  const double h = poses.step_s;
  const Eigen::Quaterniond world_to_body = pose.rotation().conjugate();
  const Eigen::Vector3d velocity = (after - before) / (2.0 * h);
  const Eigen::Vector3d acceleration =
      (after - 2.0 * p + before) / (h * h) + Eigen::Vector3d(0, 0, kGravity_mps2);
  const Eigen::Vector3d a = world_to_body * acceleration;
  const Eigen::Vector3d w =
      so3_log(poses.T_world_imu_before.rotation().conjugate() * poses.T_world_imu_after.rotation()) /
      (2.0 * h);
  const Eigen::Matrix3d R = pose.rotation().toRotationMatrix();
  const double roll = std::atan2(R(2, 1), R(2, 2));
  const double pitch = std::asin(-R(2, 0));
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  // KITTI's forward, left and up are level: parallel to the earth, whatever the car's tilt.
  const Eigen::Vector3d v = Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()) * velocity;
  const auto [latitude, longitude] = geographic(p.x(), p.y());
  std::string line = fmt::format("{:.12f} {:.12f} {:.6f} {:.10f} {:.10f} {:.10f}", latitude, longitude,
                                 p.z() + 100.0, roll, pitch, yaw);
  // north and east; then forward, left, up; KITTI repeats accelerations and rates for vehicle and level axes
  for (const double value : {velocity.y(), velocity.x(), v.x(), v.y(), v.z(), a.x(), a.y(), a.z(), a.x(),
                             a.y(), a.z(), w.x(), w.y(), w.z(), w.x(), w.y(), w.z()}) {
    line += fmt::format(" {:.8f}", value);
  }
  return line + " 0.01 0.01 4 10 4 4 0";
}

}  // namespace mlo::simulator
