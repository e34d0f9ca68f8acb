#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"

namespace mlo::test {

inline constexpr double kLidarHeight_m = 1.73;

/// Points with marks of the ground, put together by hand.
struct MadeScan {
  std::vector<Point> points;
  std::vector<std::uint8_t> is_ground;

  void add(const Eigen::Vector3d& p_lidar, bool ground = false) {
    points.push_back({.p_lidar = p_lidar.cast<float>()});
    is_ground.push_back(ground ? 1 : 0);
  }
  /// Level ground in rings around the lidar, without what lies below the boxes.
  void add_ground(const std::vector<Box3d>& on_it, double reach_m = 40.0) {
    for (double range_m = 4.0; range_m < reach_m; range_m *= 1.04) {
      for (double azimuth = -3.14; azimuth < 3.14; azimuth += 0.01) {
        const Eigen::Vector3d p(range_m * std::cos(azimuth), range_m * std::sin(azimuth), -kLidarHeight_m);
        bool free = true;
        for (const Box3d& box : on_it) {
          free = free && !box.contains({p.x(), p.y(), box.center_lidar_m.z()});
        }
        if (free) add(p, true);
      }
    }
  }
  /// A car: its body up to the belt, above it the cabin.
  void add_car(const Box3d& car) {
    Box3d body = car;
    body.size_lwh_m.z() *= 0.6;
    body.center_lidar_m.z() -= 0.2 * car.size_lwh_m.z();
    Box3d cabin = car;
    cabin.size_lwh_m = cabin.size_lwh_m.cwiseProduct(Eigen::Vector3d(0.5, 0.85, 0.4));
    cabin.center_lidar_m.z() += 0.3 * car.size_lwh_m.z();
    add_box(body);
    add_box(cabin, 0.16, 0.05);  // half of what meets glass is lost
  }
  /// The two sides of a box that face the lidar, as rows of points from above its lower edge.
  void add_box(const Box3d& box, double step_m = 0.08, double from_m = 0.25) {
    std::mt19937 rng(3);
    std::normal_distribution<double> noise(0.0, 0.015);
    const SE3 T_lidar_object = box.T_lidar_object();
    const Eigen::Vector3d lidar_in_box = T_lidar_object.inverse() * Eigen::Vector3d::Zero();
    const Eigen::Vector3d half = 0.5 * box.size_lwh_m;
    const double x_side = lidar_in_box.x() > 0.0 ? half.x() : -half.x();
    const double y_side = lidar_in_box.y() > 0.0 ? half.y() : -half.y();
    const auto put = [&](double x, double y, double z) {
      add(T_lidar_object * Eigen::Vector3d(x + noise(rng), y + noise(rng), z));
    };
    for (double z = -half.z() + from_m; z < half.z(); z += 0.15) {
      if (std::abs(lidar_in_box.y()) > half.y()) {
        for (double x = -half.x(); x < half.x(); x += step_m) put(x, y_side, z);
      }
      if (std::abs(lidar_in_box.x()) > half.x()) {
        for (double y = -half.y(); y < half.y(); y += step_m) put(x_side, y, z);
      }
    }
  }
};

/// On level ground below a lidar at KITTI's height.
inline Box3d standing(double x_m, double y_m, const Eigen::Vector3d& size_lwh_m, double yaw_rad) {
  return {{x_m, y_m, -kLidarHeight_m + 0.5 * size_lwh_m.z()}, size_lwh_m, yaw_rad};
}

/// Cars beside a wall, a pole and a bush.
inline MadeScan street_with(const std::vector<Box3d>& cars) {
  MadeScan scan;
  scan.add_ground(cars);
  for (const Box3d& car : cars) scan.add_car(car);
  for (double x = -30.0; x < 30.0; x += 0.1) {
    for (double z = -1.5; z < 4.0; z += 0.25) scan.add({x, 11.0, z});
  }
  for (double z = -1.5; z < 4.0; z += 0.15) {
    for (const double y : {-8.05, -8.0, -7.95}) scan.add({6.0, y, z});
  }
  std::mt19937 rng(9);
  std::normal_distribution<double> normal(0.0, 0.6);
  for (int i = 0; i < 400; ++i) {
    scan.add({-14.0 + normal(rng), -9.0 + normal(rng), -1.4 + std::abs(2.0 * normal(rng))});
  }
  return scan;
}

inline const std::vector<Box3d> kParkedCars{standing(14.0, 6.0, {4.1, 1.75, 1.5}, 0.6),
                                            standing(-10.0, 5.0, {4.3, 1.8, 1.5}, 1.4)};

}  // namespace mlo::test
