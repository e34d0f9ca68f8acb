#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "mlo/core/se3.hpp"
#include "mlo/core/types.hpp"
#include "mlo/scene/config.hpp"

namespace mlo {

/// Moves the results of a run in the map frame: scene.mlo, trajectory*.txt, object_trajectories and the poses
/// and velocities in objects.csv. What tells of the run itself stays: odometry.txt, per_scan.csv. Shapes of
/// objects are in their own frames.
/// @param corrections  one for each scan of the scene
/// @param map          replaces the static map
/// @param T_camera0_lidar  where known, for trajectory_camera.txt
/// @throws InputError when a file cannot be read or written
void move_results(const std::filesystem::path& folder, std::span<const SE3> corrections,
                  std::span<const MapPoint> map, const std::optional<SE3>& T_camera0_lidar,
                  const SceneConfig& config);

}  // namespace mlo
