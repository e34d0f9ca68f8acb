#pragma once

#include <map>
#include <string>
#include <vector>

#include "mlo/io/dataset.hpp"
#include "mlo/io/detection_check.hpp"
#include "mlo/io/detections.hpp"

namespace mlo {

/// Smallest, middle and largest of some values; all 0 without values.
struct Spread {
  double min = 0.0;
  double median = 0.0;
  double max = 0.0;
};
Spread spread_of(std::vector<double> values);

/// A place where more time than usual passes between scans.
struct StampGap {
  std::size_t frame = 0;  ///< of the scan before
  double length_s = 0.0;
};

/// What a dataset holds, and what looks wrong with it. Counts of points, rings and ranges come from the scans
/// read.
struct DatasetReport {
  std::size_t scans = 0;
  std::size_t first_frame = 0;
  std::size_t last_frame = 0;
  double duration_s = 0.0;  ///< from the first stamp to the last
  double rate_hz = 0.0;     ///< by the median difference of stamps; 0 with fewer than two scans
  std::vector<StampGap> gaps;

  std::size_t scans_read = 0;
  std::size_t scans_missing = 0;     ///< of those read: without a file
  std::size_t scans_unreadable = 0;  ///< of those read: truncated, empty or without a valid point
  Spread points;                     ///< per scan
  std::size_t invalid_points = 0;    ///< left out of all scans read
  Spread rings;                      ///< scan lines per scan, 0 where unknown
  Spread range_m;                    ///< smallest and largest of all, median of the scans' medians
  Spread sweep_fraction;             ///< the same of the times within the sweep
  bool motion_compensated = false;
  std::size_t poses = 0;  ///< of the ground truth
  double path_m = 0.0;    ///< length of the ground truth

  std::vector<std::string> findings;  ///< what looks wrong, one sentence each
};

/// @param max_scans  how many scans to read, evenly spread, first and last included; 0 reads all
DatasetReport report_on(const Dataset& dataset, std::size_t max_scans);

/// Which objects belong to the scans of a dataset, and whether they fit them.
struct DetectionReport {
  std::size_t boxes = 0;                        ///< of all scans
  std::size_t scans = 0;                        ///< with boxes
  std::map<std::string, std::size_t> by_class;  ///< boxes of each class, by its name
  DetectionCheck check;                         ///< on up to ten scans with boxes, evenly spread
};

DetectionReport report_on_detections(const Dataset& dataset, const DetectionList& detections);

}  // namespace mlo
