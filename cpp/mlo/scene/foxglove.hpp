#pragma once

#include <span>
#include <string>
#include <string_view>

#include "mlo/core/se3.hpp"
#include "mlo/scene/records.hpp"

// Messages as Foxglove's viewers know them (https://docs.foxglove.dev/docs/visualization/message-schemas), in
// JSON.
namespace mlo::foxglove {

std::uint64_t to_ns(double stamp_s);

/// JSON Schema of a message, by the part of its name after "foxglove.".
/// @param name  PointCloud, PoseInFrame, PosesInFrame, SceneUpdate or FrameTransforms
std::string schema(std::string_view name);

/// foxglove.PointCloud: x, y, z (float32), intensity and label (uint8).
std::string point_cloud(const SceneCloud& cloud, std::string_view frame, double stamp_s);
/// foxglove.PoseInFrame
std::string pose_in_frame(const SE3& pose, std::string_view frame, double stamp_s);
/// foxglove.PosesInFrame
std::string poses_in_frame(std::span<const SE3> poses, std::string_view frame, double stamp_s);
/// Name of the frame of an object.
std::string object_frame(long id);
/// foxglove.FrameTransforms: map to odom to lidar, and map to each object.
std::string frame_transforms(const SceneScan& scan);
/// foxglove.SceneUpdate: a box, a name and an arrow of one second's motion for each object.
/// @param gone  ids that were there before and are no more
std::string scene_update(const SceneScan& scan, std::span<const long> gone);

}  // namespace mlo::foxglove
