#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"

namespace mlo {

/// Where one object is at the stamp of one scan: a row of objects.csv (docs/evaluation.md).
struct ObjectPose {
  std::size_t frame = 0;
  std::optional<double> stamp_s;
  long id = 0;        ///< the same for an object (or what is taken for one) in all its rows
  std::string type;   ///< lower case: car, van, truck, pedestrian, cyclist ...
  std::string state;  ///< moving, at_rest, or empty where nobody says
  SE3 T_map_object;   ///< body-fixed frame: centre of the box, x ahead, z up
  Eigen::Vector3d size_lwh_m = Eigen::Vector3d::Zero();  ///< zero where it is not known
  std::optional<std::size_t> points;                     ///< returns from it in this scan, where known
  std::optional<double> visible_share = {};  ///< of its sides that face the lidar, in [0, 1], where known
};

}  // namespace mlo
