#pragma once

#include <span>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"
#include "mlo/mapping/config.hpp"
#include "mlo/mapping/local_map.hpp"

namespace mlo {

/// How far points lie from where a map has them.
struct Displacement {
  bool known = false;  ///< false: too few points found anything near
  Eigen::Vector2d shift_map_m = Eigen::Vector2d::Zero();
  double turn_rad = 0.0;                                 ///< about the vertical through the centre
  Eigen::Vector3d center_map = Eigen::Vector3d::Zero();  ///< of the points [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the shift [m^2]

  /// Share of the points that lie on the map, as they are and after the shift: what has moved fits better
  /// then, a part that was not seen before does not.
  double fit_before = 0.0;
  double fit_after = 0.0;

  double length_m() const { return shift_map_m.norm(); }
  /// In the least certain direction.
  double sd_m() const;
  /// Of the shift, in standard deviations.
  double significance() const;
};

/// The shift and turn about the vertical that bring points onto a map of the object where it stood.
/// @param points_map  map frame [m]
Displacement measure_displacement(std::span<const Eigen::Vector3f> points_map, const LocalMap& at_rest,
                                  const DynamicCheckConfig& config, const RefinementConfig& shapes);

/// The same asked the other way: what the map's points say of the surface that is seen now.
struct MapFit {
  double misfit = 0.0;  ///< mean robust distance from where they are now, 0 to 1
  double gain = 0.0;    ///< by how much the displacement lowers it, as a share; at most 1, negative for worse
};

/// What comes into view beside an object's known part seems displaced; but the known part is still in its
/// place then, while of what has moved nothing is.
/// @param map_points_object  of the map, in the object's frame [m]; those on sides that are not seen now are
///                           left out
/// @param T_map_object       pose at which the object rested
/// @param points_map         that are seen now, map frame [m]
/// @param displacement       of those points from the map, known
MapFit fit_map(std::span<const Eigen::Vector3f> map_points_object, const SE3& T_map_object,
               std::span<const Eigen::Vector3f> points_map, const Displacement& displacement,
               const DynamicCheckConfig& config, const RefinementConfig& shapes);

}  // namespace mlo
