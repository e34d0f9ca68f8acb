#include "mlo/reproduction/tracking_runs.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "mlo/evaluation/tracking_evaluation.hpp"
#include "mlo/io/calibration.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/pipeline/track_detections.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 10> kTenSequences{"0000", "0002", "0003", "0004", "0005",
                                                    "0007", "0009", "0011", "0017", "0020"};
constexpr double kInterval_s = 0.1;

struct SequenceRun {
  SequenceRecords records;
  std::vector<double> times_ms;
};

std::optional<SequenceRun> run_sequence(const KittiData& data, const std::string& sequence) {
  if (!data.calibration || !data.car_detections) return std::nullopt;
  const std::string file_name = sequence + ".txt";
  const fs::path boxes = *data.car_detections / file_name;
  const fs::path calibration_file = *data.calibration / file_name;
  if (!fs::exists(boxes) || !fs::exists(calibration_file)) return std::nullopt;
  const Calibration calibration = read_calibration_file(calibration_file);
  if (!calibration.T_camera0_lidar || !calibration.P2) return std::nullopt;
  const CameraView view{*calibration.T_camera0_lidar, *calibration.P2};

  SequenceRun run;
  run.records.name = sequence;
  const DetectionList detections = read_detections({boxes}, calibration, {.sequence = sequence});
  TrackingConfig config;
  config.lifecycle.field_of_view_deg = std::min(config.lifecycle.field_of_view_deg, view.width_deg());
  const std::vector<FrameTracks> frames = track_detections(detections, std::nullopt, kInterval_s, config);
  for (const FrameTracks& frame : frames) run.times_ms.push_back(frame.tracking_ms);
  run.records.tracks = kitti_records(frames, view);
  if (const fs::path labels = data.labels.value_or("") / file_name; fs::exists(labels)) {
    run.records.truth = read_kitti_tracks(labels);
  }
  return run;
}

TrackingRun summary_of(const std::vector<SequenceRun>& runs, bool scored) {
  TrackingRun summary;
  std::vector<SequenceRecords> records;
  std::size_t scans = 0;
  for (const SequenceRun& run : runs) {
    for (const double time_ms : run.times_ms) {
      summary.mean_ms += time_ms;
      summary.largest_ms = std::max(summary.largest_ms, time_ms);
    }
    scans += run.times_ms.size();
    records.push_back(run.records);
  }
  summary.mean_ms /= static_cast<double>(std::max<std::size_t>(1, scans));
  if (!scored) return summary;
  const ClearMot clear = evaluate_tracking(records, {}).all.clear;
  summary.mota_percent = 100.0 * clear.mota();
  summary.motp_percent = 100.0 * clear.motp();
  return summary;
}

}  // namespace

std::optional<TrackingRun> track_ten_sequences(const KittiData& data) {
  std::vector<SequenceRun> runs;
  for (const char* sequence : kTenSequences) {
    std::optional<SequenceRun> run = run_sequence(data, sequence);
    if (!run || run->records.truth.empty()) return std::nullopt;
    runs.push_back(std::move(*run));
  }
  return summary_of(runs, true);
}

std::optional<TrackingRun> track_sequence(const KittiData& data, const std::string& sequence) {
  std::optional<SequenceRun> run = run_sequence(data, sequence);
  if (!run) return std::nullopt;
  const bool scored = !run->records.truth.empty();
  return summary_of({std::move(*run)}, scored);
}

}  // namespace mlo
