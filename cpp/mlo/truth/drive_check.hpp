#pragma once

#include <cstddef>
#include <optional>

#include "mlo/io/dataset.hpp"

namespace mlo {

/// How well the scans of a drive agree by given poses.
struct DriveConsistency {
  std::optional<double> median_m;  ///< of the residuals of all pairs of scans
  std::optional<double> mean_m;
  std::size_t residuals = 0;
};

/// Distances of the points of each scan from the planes of the one `lag` scans before, both undistorted and
/// placed by the poses. Scans without a pose are left out.
/// @param poses  T_map_lidar by frame, at the scans' stamps
DriveConsistency check_drive(const Dataset& dataset, const PoseList& poses, std::size_t lag);

}  // namespace mlo
