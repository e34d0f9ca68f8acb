#pragma once

#include "mlo/odometry/config.hpp"
#include "mlo/odometry/consistency_check.hpp"
#include "mlo/odometry/placement.hpp"
#include "mlo/odometry/reference_scan.hpp"

namespace mlo {

/// The horizontal motion, on a grid of start_radius_m around rest, by which the background features lie
/// nearest to their candidates: a start where nothing predicts the motion. Of equally good motions the
/// smallest wins.
SE3 search_start(const EgoFeatures& features, const ReferenceScan& previous, const SweepTiming& timing,
                 const OdometryConfig& config);

}  // namespace mlo
