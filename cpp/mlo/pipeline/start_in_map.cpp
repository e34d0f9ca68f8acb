#include "mlo/pipeline/start_in_map.hpp"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/core/heading.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/scene/scene_file.hpp"

namespace mlo {
namespace {

// Roll and pitch are those of the nearest of some other poses.
SE3 pose_at(const Eigen::Vector4d& x_y_z_m_yaw_deg, const std::vector<SE3>& others) {
  const Eigen::Vector3d place_m = x_y_z_m_yaw_deg.head<3>();
  const auto distance_m = [&](const SE3& pose) { return (pose.translation() - place_m).norm(); };
  const SE3& nearest = *std::min_element(others.begin(), others.end(), [&](const SE3& a, const SE3& b) {
    return distance_m(a) < distance_m(b);
  });
  const double turn_rad = x_y_z_m_yaw_deg.w() * std::numbers::pi / 180.0 - yaw_of(nearest);
  return {so3_exp({0.0, 0.0, turn_rad}) * nearest.rotation(), place_m};
}

}  // namespace

StartInMap start_in_map(const std::filesystem::path& file, const std::optional<Eigen::Vector4d>& start) {
  StartInMap result{.file = file};
  std::vector<SE3> poses{SE3()};
  if (file.extension() == ".mlo") {
    const SceneFile scene(file);
    result.points = scene.map();
    if (scene.num_scans() > 0) poses = robot_poses(scene).T_world_body;
  } else {
    result.points = read_map(file);
  }
  if (result.points.empty()) {
    throw InputError(fmt::format("{}: holds no map; give that of a run that was finished", file.string()));
  }
  result.T_map_lidar = start ? pose_at(*start, poses) : poses.front();
  return result;
}

}  // namespace mlo
