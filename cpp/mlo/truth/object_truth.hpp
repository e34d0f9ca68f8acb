#pragma once

#include <span>
#include <vector>

#include "mlo/core/object_pose.hpp"
#include "mlo/core/object_record.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/io/dataset.hpp"

namespace mlo {

/// KITTI's boxes in the map frame: annotated box in the lidar frame times the lidar's pose (paper, section
/// IV). DontCare regions and boxes in frames without a pose are left out.
/// @param records          labels or results of one sequence
/// @param poses            T_map_lidar by frame; their stamps go into the result
/// @param T_camera0_lidar  of the sequence's calibration
std::vector<ObjectPose> objects_in_map(std::span<const ObjectRecord> records, const PoseList& poses,
                                       const SE3& T_camera0_lidar);

}  // namespace mlo
