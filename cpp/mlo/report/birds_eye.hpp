#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "mlo/core/object_pose.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/core/types.hpp"

namespace mlo {

struct BirdsEyeOptions {
  std::size_t width_px = 900;
  std::size_t max_height_px = 900;
  double margin_m = 20.0;  ///< around the path; what is farther is cut off
};

/// Map, path and objects seen from above as an SVG element: the map as an embedded grey image (ground light,
/// what stands dark), the path and the ways of moving objects as lines, the last places of others as dots, a
/// scale bar. Empty without any finite pose.
/// @param path  T_map_lidar
std::string birds_eye_svg(std::span<const MapPoint> map, std::span<const SE3> path,
                          std::span<const ObjectPose> objects, const BirdsEyeOptions& options = {});

}  // namespace mlo
