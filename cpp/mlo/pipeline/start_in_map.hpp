#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"
#include "mlo/core/types.hpp"

namespace mlo {

/// Where to localise instead of making a map.
struct StartInMap {
  std::filesystem::path file;
  std::vector<MapPoint> points = {};
  SE3 T_map_lidar = {};  ///< of the first scan, roughly
};

/// The map of an earlier run.
/// @param file   scene.mlo, or a map as .ply or .pcd
/// @param start  x, y, z [m] and yaw [deg] in the map; roll and pitch are those of the nearest pose of the
/// run that made the map. Nothing: the first pose of that run. A .ply or .pcd knows the pose at its origin
/// only.
/// @throws InputError when the file cannot be read or has no map
StartInMap start_in_map(const std::filesystem::path& file, const std::optional<Eigen::Vector4d>& start);

}  // namespace mlo
