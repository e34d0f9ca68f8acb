#include "mlo/truth/drive_check.hpp"

#include <deque>
#include <vector>

#include "mlo/evaluation/scan_consistency.hpp"
#include "mlo/truth/placed_scan.hpp"

namespace mlo {

DriveConsistency check_drive(const Dataset& dataset, const PoseList& poses, std::size_t lag) {
  const PosesByFrame pose_of(poses);
  std::deque<std::vector<Eigen::Vector3f>> before;  // the last scans; empty where there is none
  ScanConsistency all;
  for (std::size_t i = 0; i < dataset.scans->size(); ++i) {
    std::vector<Eigen::Vector3f> points;
    const std::size_t frame = dataset.scans->frame(i);
    const SE3* pose = pose_of.find(frame);
    const ScanReading reading = pose == nullptr ? ScanReading{} : dataset.scans->read(i);
    if (reading.scan)
      points = place_scan(*reading.scan, dataset.sensor, *pose, pose_of.motion_per_sweep(frame));
    if (before.size() == lag) {
      const ScanConsistency pair = scan_consistency(before.front(), points);
      all.residuals_m.insert(all.residuals_m.end(), pair.residuals_m.begin(), pair.residuals_m.end());
      before.pop_front();
    }
    before.push_back(std::move(points));
  }
  return {.median_m = all.median_m(), .mean_m = all.mean_m(), .residuals = all.residuals_m.size()};
}

}  // namespace mlo
