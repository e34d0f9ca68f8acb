#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mlo/core/labelled_point.hpp"
#include "mlo/io/dataset.hpp"
#include "mlo/io/labelled_points.hpp"

namespace mlo {

/// The labelled points of all scans in one map, and what could not be used.
struct LabelledMap {
  std::vector<LabelledPoint> points;
  std::size_t scans = 0;              ///< that are in it
  std::vector<std::string> problems;  ///< one sentence for each scan that is not
};

/// Folder of a data set's point labels (NNNNNN.label, one per scan): labels beside the scans' folder, as in
/// SemanticKITTI, or labels/NNNN for the tracking layout. Nothing if there is none.
std::optional<std::filesystem::path> find_point_labels(const Dataset& dataset);

/// Puts the labelled scans where the poses say; scans with motion distortion are undistorted with the motion
/// that the neighbouring poses imply. One point is kept per voxel and mobility, the first.
/// @param poses    T_map_lidar by frame
/// @param voxel_m  side of the voxels [m], > 0
LabelledMap build_labelled_map(const Dataset& dataset, const std::filesystem::path& labels,
                               const PoseList& poses, double voxel_m,
                               Movable movable = Movable::counts_as_at_rest);

}  // namespace mlo
