#pragma once

#include <vector>

#include "mlo/scene/records.hpp"
#include "mlo/scene/scene_file.hpp"

namespace mlo {

/// The scene at one moment.
struct SceneState {
  double stamp_s = 0.0;
  std::uint64_t frame = 0;                  ///< of the nearest scan
  ScanStatus status = ScanStatus::skipped;  ///< of the nearest scan
  SE3 T_map_lidar = {};                     ///< on the manifold between the scans before and after
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of the nearest scan
  std::vector<SceneObject> objects = {};  ///< by id; those of both scans interpolated, others of the nearest
};

/// Reads two scans at most, wherever they are in the file.
/// @throws InputError when the time is not within the scene, or the data is damaged
SceneState state_at(const SceneFile& scene, double stamp_s);

}  // namespace mlo
