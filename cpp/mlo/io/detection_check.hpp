#pragma once

#include <span>
#include <string>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"
#include "mlo/io/dataset.hpp"

namespace mlo {

/// A scan and the detections that belong to it.
struct ScanWithDetections {
  std::span<const Point> points;
  std::vector<Detection> detections;
};

struct DetectionCheckOptions {
  double max_range_m = 40.0;     ///< farther boxes may well be empty
  double min_confidence = 0.5;   ///< false alarms tell nothing about frames
  std::size_t min_points = 10;   ///< points in a box that holds any
  double min_share = 0.6;        ///< of boxes that hold points, below which something is wrong
  double margin_m = 0.1;         ///< boxes are drawn tightly
  double ground_height_m = 0.3;  ///< points lower than this above the ground around a box are not its object
  double min_gain = 0.15;        ///< of the score, that makes a mistake the better explanation
};

/// Whether detections fit the scans.
struct DetectionCheck {
  std::size_t boxes = 0;              ///< that were looked at
  std::size_t boxes_with_points = 0;  ///< as they are
  double score = 0.0;                 ///< how well the boxes hold the points around them, best 1
  double best_score = 0.0;            ///< the same had the mistake below been undone
  std::string mistake;                ///< a usual mistake that explains it; empty: none
  std::string problem;  ///< a sentence with remedy; empty: the detections fit, or too few to tell
};

/// Boxes must hold points. Tries the usual mistakes - camera frame taken for the lidar's, centre for the
/// bottom face, length for width, height for length, degrees for radians, the sign of the yaw, KITTI's
/// rotation_y for the yaw - and says which one explains the scans clearly better than what is given. Ten
/// scans from all over the sequence are enough. A scene in which a mistake changes nothing (all cars parallel
/// to the axes) can not show it.
/// @param calibration  where the camera is; without it, a camera at the lidar's place looking along its x
/// axis
DetectionCheck check_detections(std::span<const ScanWithDetections> scans, const Calibration& calibration,
                                const DetectionCheckOptions& options = {});

}  // namespace mlo
