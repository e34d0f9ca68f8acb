#pragma once

#include <filesystem>
#include <vector>

#include "mlo/scene/scene_writer.hpp"

namespace mlo::test {

/// A scan of a robot that drives 1 m a scan along x and turns, beside an object that it overtakes.
inline SceneScan small_scan(std::size_t i) {
  const auto k = static_cast<double>(i);
  SceneScan scan{.frame = 10 + i, .stamp_s = 100.0 + 0.1 * k, .status = ScanStatus::localised};
  scan.T_map_lidar = SE3::exp((SE3::Tangent() << k, 0.0, 0.0, 0.0, 0.0, 0.1 * k).finished());
  scan.T_odom_lidar = scan.T_map_lidar;
  scan.covariance = Eigen::Matrix<double, 6, 6>::Identity() * (1.0 + k);
  scan.objects.push_back(
      {.id = 3, .object_class = ObjectClass::van, .moving = true, .moving_probability = 0.9});
  scan.objects[0].T_map_object = SE3(Eigen::Quaterniond::Identity(), {0.5 * k, 4.0, 0.0});
  scan.objects[0].velocity_map_mps = {k, 0.0};
  return scan;
}

/// A few points of the ground and of object 3.
inline SceneCloud small_cloud(std::size_t i) {
  SceneCloud cloud;
  for (int n = 0; n < 20; ++n) {
    cloud.add({{0.5F * static_cast<float>(n), static_cast<float>(i), -1.7F}, 0.25F}, MapLabel::ground);
  }
  cloud.add({{3.0F, 4.0F, -0.5F}, 1.0F}, MapLabel::object, 3);
  return cloud;
}

inline std::vector<MapPoint> small_map() {
  std::vector<MapPoint> points;
  for (int n = -50; n < 50; ++n) {
    points.push_back({{static_cast<float>(n) * 0.7F, 3.0F, 0.25F},
                      0.5F,
                      n % 2 == 0 ? MapLabel::ground : MapLabel::surface});
  }
  return points;
}

/// Of object 3.
inline SceneCloud small_shape() {
  SceneCloud shape;
  for (int n = 0; n < 10; ++n) shape.add({{0.2F * static_cast<float>(n), -1.0F, 0.5F}}, MapLabel::object, 3);
  return shape;
}

/// Writes such a scene; without an end, as a killed run leaves it.
inline void write_small_scene(const std::filesystem::path& path, std::size_t num_scans,
                              bool finished = true) {
  SceneWriter writer(path, {.program_version = "1.2", .configuration = "a: 1\n"}, {});
  for (std::size_t i = 0; i < num_scans; ++i) {
    const SceneCloud cloud = small_cloud(i);
    writer.write(small_scan(i), &cloud);
  }
  if (!finished) return;
  writer.write_map(small_map());
  writer.write_object(3, small_shape());
  writer.finish();
}

}  // namespace mlo::test
