#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <tsl/robin_set.h>

#include "mlo/core/se3.hpp"
#include "mlo/core/voxel_grid.hpp"
#include "mlo/mapping/config.hpp"
#include "mlo/mapping/local_map.hpp"

namespace mlo {

/// The points of one object in its own frame, one per voxel, in the order in which they were seen.
class ObjectMap {
 public:
  /// @param points_map    map frame [m]
  /// @param T_map_object  the object's pose when they were seen
  void insert(std::span<const Eigen::Vector3f> points_map, const SE3& T_map_object, double voxel_m);
  void clear();
  const std::vector<Eigen::Vector3f>& points_object() const { return points_; }
  static void archive(auto& self, auto& bytes) { bytes(self.points_, self.taken_); }  // core/archive.hpp

 private:
  std::vector<Eigen::Vector3f> points_;
  tsl::robin_set<VoxelKey, VoxelKeyHash> taken_;
};

/// How far points lie from where a map has them.
struct Displacement {
  bool known = false;  ///< false: too few points found anything near
  Eigen::Vector2d shift_map_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the shift [m^2]

  /// Share of the points that lie on the map, as they are and after the shift: what has moved fits better
  /// then, a part that was not seen before does not.
  double fit_before = 0.0;
  double fit_after = 0.0;

  /// By how much the shift lowers the points' robust distances from the map, new parts included: from 0, not
  /// at all, to 1, wholly.
  double loss_gain = 0.0;

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

}  // namespace mlo
