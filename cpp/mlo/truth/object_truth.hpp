#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/object_pose.hpp"
#include "mlo/core/object_record.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/io/dataset.hpp"

namespace mlo {

/// One annotated or tracked box in the lidar frame.
struct ObjectBox {
  std::size_t frame = 0;
  long id = 0;
  std::string type;  ///< lower case
  Box3d box_lidar;
};

/// KITTI tracking labels or results of one sequence, without DontCare regions.
std::vector<ObjectBox> boxes_in_lidar(std::span<const ObjectRecord> records, const SE3& T_camera0_lidar);

/// Annotations of a KITTI raw drive (tracklet_labels.xml); ids are the numbers of the tracklets in the file.
/// @throws InputError naming the file and what is wrong in it
std::vector<ObjectBox> read_tracklets(const std::filesystem::path& file);

/// The annotations that lie beside the data: labels of the tracking benchmark, or tracklets of a raw drive;
/// empty where there are neither.
std::vector<ObjectBox> annotated_boxes(const Dataset& dataset);

/// The boxes in the map frame: box in the lidar frame times the lidar's pose (paper, section IV), sorted by
/// frame and id. Those in frames without a pose are left out.
/// @param poses  T_map_lidar by frame; their stamps go into the result
std::vector<ObjectPose> objects_in_map(std::span<const ObjectBox> boxes, const PoseList& poses);

}  // namespace mlo
