#pragma once

#include <optional>
#include <string>

#include "mlo/reproduction/find_data.hpp"

namespace mlo {

/// Cars tracked from PointRCNN's boxes without poses, and scored in the image (TrackEval's protocol).
struct TrackingRun {
  std::optional<double> mota_percent;  ///< none without labels of the sequence
  std::optional<double> motp_percent;
  double mean_ms = 0.0;  ///< wall time of a scan
  double largest_ms = 0.0;
};

/// The ten sequences of Table III together; nothing if labels, calibration or boxes of one are missing.
std::optional<TrackingRun> track_ten_sequences(const KittiData& data);

/// One sequence; nothing if its boxes or its calibration are missing.
std::optional<TrackingRun> track_sequence(const KittiData& data, const std::string& sequence);

}  // namespace mlo
