#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"
#include "mlo/core/sensor.hpp"
#include "mlo/core/types.hpp"
#include "mlo/io/dataset.hpp"

namespace mlo {

/// Poses that can be asked for by frame.
class PosesByFrame {
 public:
  explicit PosesByFrame(const PoseList& poses);

  /// None where there is no finite pose.
  const SE3* find(std::size_t frame) const;
  /// Motion of the body during one sweep, between the neighbours of a frame that has a pose, or from the one
  /// that there is.
  SE3 motion_per_sweep(std::size_t frame) const;

 private:
  std::map<std::size_t, SE3> T_map_body_;
};

/// The points of a scan in the map, one for one: elevations corrected, distortion removed. Those outside the
/// sensor's range limits are NaN.
/// @param motion_per_sweep  of the lidar, from the start of a sweep to its end
std::vector<Eigen::Vector3f> place_scan(const Scan& scan, const SensorConfig& sensor, const SE3& T_map_lidar,
                                        const SE3& motion_per_sweep);

}  // namespace mlo
