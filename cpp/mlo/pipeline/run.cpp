#include "mlo/pipeline/run.hpp"

#include <algorithm>
#include <future>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/detection_check.hpp"
#include "mlo/pipeline/pipeline.hpp"
#include "mlo/pipeline/run_output.hpp"
#include "mlo/pipeline/run_report.hpp"

namespace mlo {
namespace {

constexpr std::size_t kMaxListedProblems = 20;
// Detections are checked against this many scans; more would say the same.
constexpr std::size_t kCheckedScans = 10;

std::vector<std::size_t> select_indices(const Dataset& dataset, const RunOptions& options) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < dataset.scans->size(); ++i) {
    const std::size_t frame = dataset.scans->frame(i);
    if (frame >= options.first_frame && frame <= options.last_frame) indices.push_back(i);
  }
  if (indices.empty()) {
    throw InputError(fmt::format("{}: none of its {} scans is within the frames asked for ({} to {})",
                                 dataset.root.string(), dataset.scans->size(), options.first_frame,
                                 options.last_frame));
  }
  return indices;
}

// Boxes that hold no points are most often in the wrong frame, unit or convention. Looks at scans from all
// over the sequence.
void warn_of_strange_boxes(const Dataset& dataset, const std::vector<std::size_t>& indices,
                           const DetectionList& list, RunSummary& summary) {
  std::vector<Scan> scans;
  std::vector<ScanWithDetections> samples;
  const std::size_t step = std::max<std::size_t>(1, indices.size() / kCheckedScans);
  scans.reserve(indices.size() / step + 1);  // samples refer to the elements
  for (std::size_t i = 0; i < indices.size(); i += step) {
    ScanReading reading = dataset.scans->read(indices[i]);
    if (!reading.scan) continue;
    std::vector<Detection> boxes = list.detections_at(reading.scan->frame, reading.scan->stamp_s);
    if (boxes.empty()) continue;
    scans.push_back(std::move(*reading.scan));
    samples.push_back({scans.back().points, std::move(boxes)});
  }
  const std::string problem = check_detections(samples, dataset.calibration).problem;
  if (!problem.empty()) summary.warnings.push_back(problem);
}

FrameResult process(const Scan& scan, const std::optional<DetectionList>& detections, Pipeline& pipeline) {
  if (!detections) return pipeline.process(scan);
  return pipeline.process(scan, detections->detections_at(scan.frame, scan.stamp_s));
}

void tally(const FrameResult& result, RunSummary& summary) {
  ++summary.processed;
  summary.detections += result.counts.objects;
  summary.times.push_back(result.times);
  if (!result.localised()) ++summary.predicted;
  if (result.refinement.degenerate_directions > 0) ++summary.degenerate;
  if (result.odometry.degenerate_directions > 0) ++summary.odometry_degenerate;
  if (result.consistency.run && !result.consistency.passed) ++summary.failed_checks;
}

// As run.json names it.
std::string boxes_from(bool given, Detector detector) {
  if (given) return "given";
  switch (detector) {
    case Detector::cluster:
      return "cluster";
    case Detector::none:
      break;
  }
  return "none";
}

/// The last scan that was processed, and how many were skipped since.
struct Progress {
  double stamp_s = 0.0;
  double duration_s = 0.0;
  double skipped_since = 0.0;
};

void skip(std::size_t frame, const std::string& problem, const Progress& progress, const Pipeline& pipeline,
          RunOutput& output, RunSummary& summary) {
  const double stamp_s = progress.stamp_s + progress.skipped_since * progress.duration_s;
  output.write_skipped(frame, stamp_s, problem, pipeline.predict_poses(progress.skipped_since));
  ++summary.skipped;
  if (summary.skipped <= kMaxListedProblems) {
    summary.warnings.push_back(fmt::format("scan {} was skipped: {}", frame, problem));
  }
}

// What is written once, at the end.
void finish(const Pipeline& pipeline, RunOutput& output, RunSummary& summary) {
  const std::vector<MapPoint> map = pipeline.static_map().points();
  output.write_map(map);
  output.write_object_trajectories();
  output.write_object_maps(pipeline.object_maps());
  output.finish();
  summary.map_points = map.size();
  if (summary.skipped > kMaxListedProblems) {
    summary.warnings.push_back(fmt::format("{} more scans were skipped; per_scan.csv lists all",
                                           summary.skipped - kMaxListedProblems));
  }
}

}  // namespace

RunSummary run(const Dataset& dataset, const std::optional<DetectionList>& detections,
               const PipelineConfig& config, const RunOptions& options,
               const std::function<void(std::size_t, std::size_t)>& on_scan,
               const std::function<bool()>& should_stop) {
  const std::vector<std::size_t> indices = select_indices(dataset, options);
  RunSummary summary;
  summary.scans = indices.size();
  summary.warnings = dataset.warnings;
  if (detections) warn_of_strange_boxes(dataset, indices, *detections, summary);

  summary.boxes_from = boxes_from(detections.has_value(), config.detection.detector);
  const bool with_objects = detections || config.detection.detector != Detector::none;
  RunOutput output(options.out, dataset, config, with_objects);
  write_file_atomically(options.out / "config.yaml", to_yaml(config));
  Pipeline pipeline(config);
  std::optional<Eigen::Vector3d> last_position;
  Progress progress;
  std::size_t next_checkpoint = options.checkpoint_scans;
  std::string first_problem;
  const auto read = [&](std::size_t i) {
    return std::async(std::launch::async, [&, i] { return dataset.scans->read(indices[i]); });
  };
  std::future<ScanReading> next = read(0);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const ScanReading reading = next.get();
    if (should_stop && should_stop()) {
      summary.interrupted = true;
      break;
    }
    if (i + 1 < indices.size()) next = read(i + 1);
    summary.invalid_points += reading.invalid_points;
    if (!reading.scan) {
      if (first_problem.empty()) first_problem = reading.problem;
      ++progress.skipped_since;
      skip(dataset.scans->frame(indices[i]), reading.problem, progress, pipeline, output, summary);
    } else {
      progress = {.stamp_s = reading.scan->stamp_s, .duration_s = reading.scan->duration_s};
      FrameResult result = process(*reading.scan, detections, pipeline);
      tally(result, summary);
      const Eigen::Vector3d position = result.T_map_lidar.translation();
      output.write(std::move(result));
      if (last_position) summary.path_m += (position - *last_position).norm();
      last_position = position;
    }
    if (options.checkpoint_scans > 0 && i + 1 >= next_checkpoint) {
      output.write_map(pipeline.static_map().points());
      // Ever rarer, as the map grows: saving must not cost more per scan the longer the run is.
      next_checkpoint = std::max(i + 1 + options.checkpoint_scans, (i + 1) * 3 / 2);
    }
    if (on_scan) on_scan(i + 1, indices.size());
  }
  finish(pipeline, output, summary);
  write_file_atomically(options.out / "run.json", to_json(dataset, config, summary));
  if (summary.processed == 0 && !summary.interrupted) {
    throw InputError(fmt::format("{}: none of the {} scans could be used; the first problem: {}",
                                 dataset.root.string(), summary.scans, first_problem));
  }
  return summary;
}

}  // namespace mlo
