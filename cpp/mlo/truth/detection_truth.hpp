#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/object_pose.hpp"
#include "mlo/core/object_record.hpp"
#include "mlo/evaluation/detection_ap.hpp"
#include "mlo/io/dataset.hpp"
#include "mlo/io/detections.hpp"

namespace mlo {

/// True boxes by frame, in the lidar frame.
using LabelledFrames = std::map<std::size_t, std::vector<LabelledBox>>;

/// Height in the image of a camera like KITTI's that looks at the box, wherever it is [px].
double height_all_round_px(const Box3d& box_lidar);

/// KITTI labels, graded by what they say themselves. DontCare regions have no 3D box and are left out.
LabelledFrames labelled_boxes(std::span<const ObjectRecord> records, const SE3& T_camera0_lidar);

/// Objects known all round, graded as if a camera like KITTI's looked at each: height in its image by size
/// and distance, occlusion by the visible share (fully above 75 %, partly above 35 %). With fewer than five
/// returns an object is not demanded. Frames without a pose are left out.
/// @param poses  T_map_lidar at the stamps, by frame
LabelledFrames labelled_boxes(std::span<const ObjectPose> objects, const PoseList& poses);

/// What KITTI's labels cover: the image of camera 2.
struct LabelledView {
  SE3 T_camera0_lidar;
  Eigen::Matrix<double, 3, 4> P2;
  Eigen::Vector2d image_size_px{1242.0, 375.0};
};

/// Pairs truth and detections by frame, from the first to the last frame of the truth.
/// @param view  detections that it does not show are left out; nothing: the truth is known all round
std::vector<DetectionFrame> detection_frames(const LabelledFrames& truth, const DetectionList& detections,
                                             const std::optional<LabelledView>& view);

}  // namespace mlo
