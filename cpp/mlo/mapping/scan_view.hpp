#pragma once

#include <span>

#include "mlo/core/se3.hpp"
#include "mlo/core/sweep_motion.hpp"
#include "mlo/core/types.hpp"
#include "mlo/mapping/config.hpp"
#include "mlo/mapping/range_image.hpp"

namespace mlo {

/// A scan as a witness of what was free, with the motion and the place from which it was taken.
class ScanView {
 public:
  /// A view of nothing, to be read from an archive.
  ScanView() : ScanView({}, SweepMotion::none(), SE3()) {}
  /// @param points       the whole scan, objects too; finite, lidar frame at their own times [m]
  /// @param motion       of the lidar during the sweep
  /// @param T_map_lidar  pose at the motion's reference time
  ScanView(std::span<const Point> points, const SweepMotion& motion, const SE3& T_map_lidar)
      : image_(points),
        motion_(motion),
        R_lidar_map_(T_map_lidar.rotation().conjugate().toRotationMatrix().cast<float>()),
        center_map_(T_map_lidar.translation().cast<float>()) {}

  /// Where the lidar was [m].
  const Eigen::Vector3f& center_map() const { return center_map_; }

  /// What the scan says about a place (map frame [m]); unknown beyond the reach of free-space evidence.
  /// @param on_ground  there scan lines are far apart and say less
  Sight look(const Eigen::Vector3f& p_map, bool on_ground, const FreeSpaceConfig& config) const;

  static void archive(auto& self, auto& bytes) {  // core/archive.hpp
    bytes(self.image_, self.motion_, self.R_lidar_map_, self.center_map_);
  }

 private:
  RangeImage image_;
  SweepMotion motion_;
  Eigen::Matrix3f R_lidar_map_;
  Eigen::Vector3f center_map_;
};

}  // namespace mlo
