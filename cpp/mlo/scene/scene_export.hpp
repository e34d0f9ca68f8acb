#pragma once

#include <filesystem>
#include <vector>

#include "mlo/core/object_pose.hpp"
#include "mlo/scene/scene_file.hpp"

namespace mlo {

/// All objects in all scans, as rows of objects.csv.
std::vector<ObjectPose> object_poses(const SceneFile& scene);

/// Poses of one object at the stamps of the scans that have it.
/// @throws InputError when no scan has it
PoseList object_trajectory(const SceneFile& scene, long id);

/// All points that were seen of one object, in its own frame (origin in the middle of its box, x ahead), one
/// per voxel.
/// @throws InputError when no scan has it
std::vector<MapPoint> object_cloud(const SceneFile& scene, long id, double voxel_m);

/// The scene as an MCAP file for Foxglove: /tf, /pose, /trajectory (once), /points, /objects and /map (once),
/// in the frames map, odom and lidar.
/// @throws InputError when the file cannot be written
void export_mcap(const SceneFile& scene, const std::filesystem::path& path);

}  // namespace mlo
