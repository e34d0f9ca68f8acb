#include "mlo/pipeline/run.hpp"

#include <algorithm>
#include <future>

#include <fmt/format.h>

#include "mlo/core/archive.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/detection_check.hpp"
#include "mlo/pipeline/checkpoint.hpp"
#include "mlo/pipeline/close_loops.hpp"
#include "mlo/pipeline/find_objects.hpp"
#include "mlo/pipeline/move_results.hpp"
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
    case Detector::network:
      return "3dssd";
    case Detector::none:
      break;
  }
  return "none";
}

/// When to save something that grows with the run: ever rarer, so that it does not cost more per scan the
/// longer the run is.
struct Schedule {
  std::size_t every = 0;  // scans, at first; 0 never
  std::size_t next = 0;

  bool is_due(std::size_t done) {
    if (every == 0 || done < std::max(every, next)) return false;
    next = std::max(done + every, done * 3 / 2);
    return true;
  }
  static void archive(auto& self, auto& bytes) { bytes(self.every, self.next); }
};

/// What a run knows besides its pipeline and its files.
struct Progress {
  std::size_t next = 0;  // of the scans to be taken
  RunSummary summary;
  std::optional<Eigen::Vector3d> last_position;
  // The last scan that was processed, and how many were skipped since.
  double stamp_s = 0.0;
  double duration_s = 0.0;
  double skipped_since = 0.0;
  std::string first_problem;
  Schedule save_map, save_state;

  static void archive(auto& self, auto& bytes) {
    bytes(self.next, self.summary, self.last_position, self.stamp_s, self.duration_s, self.skipped_since,
          self.first_problem, self.save_map, self.save_state);
  }
};

// What has to be the same for a run to go on with the state of another.
std::string owner_of(const Dataset& dataset, const std::vector<std::size_t>& indices,
                     const PipelineConfig& config, const std::optional<DetectionList>& detections,
                     const std::optional<StartInMap>& map) {
  return fmt::format("mlo {}\nscans of {} {} {}\nframes {} to {}\ndetections in {} frames\nmap '{}'\n{}",
                     MLO_VERSION, dataset.root.string(), dataset.format, dataset.sequence,
                     dataset.scans->frame(indices.front()), dataset.scans->frame(indices.back()),
                     detections ? detections->by_frame.size() : 0, map ? map->file.string() : "",
                     to_yaml(config));
}

Pipeline make_pipeline(const PipelineConfig& config, const std::optional<StartInMap>& map) {
  return map ? Pipeline(config, map->points, map->T_map_lidar) : Pipeline(config);
}

// What a run was writing when it was killed (AtomicFile).
void remove_unfinished_files(const std::filesystem::path& out) {
  std::vector<std::filesystem::path> unfinished;
  for (const std::filesystem::path& folder : {out, out / "object_maps", out / "object_trajectories"}) {
    std::error_code absent;  // then there is nothing to remove
    for (const auto& entry : std::filesystem::directory_iterator(folder, absent)) {
      if (entry.path().extension().string().starts_with(".part")) unfinished.push_back(entry.path());
    }
  }
  for (const std::filesystem::path& file : unfinished) std::filesystem::remove(file);
}

class Run {
 public:
  Run(const Dataset& dataset, const std::optional<DetectionList>& detections, const PipelineConfig& config,
      const RunOptions& options)
      : dataset_(dataset),
        detections_(detections),
        config_(config),
        options_(options),
        indices_(select_indices(dataset, options)),
        owner_(owner_of(dataset, indices_, config, detections, options.map)),
        pipeline_(make_pipeline(config, options.map)) {
    if (options.resume) remove_unfinished_files(options.out);
    if (!options.resume || !load()) begin();
  }

  void take_all(const std::function<void(std::size_t, std::size_t)>& on_scan,
                const std::function<bool()>& should_stop);
  RunSummary finish();

 private:
  void begin();
  void correct(RunSummary& summary, std::vector<MapPoint>& map) const;
  bool load();
  void save();
  void take(const ScanReading& reading);
  void skip(const std::string& problem);
  void process(const Scan& scan);

  std::filesystem::path state_file() const { return options_.out / "state.bin"; }

  const Dataset& dataset_;
  const std::optional<DetectionList>& detections_;
  const PipelineConfig& config_;
  const RunOptions& options_;
  std::vector<std::size_t> indices_;
  std::string owner_;
  Pipeline pipeline_;
  Progress progress_;
  std::optional<RunOutput> output_;
  std::future<void> saving_;
};

void Run::begin() {
  RunSummary& summary = progress_.summary;
  progress_.save_map.every = options_.checkpoint_scans;
  progress_.save_state.every = options_.state_scans;
  summary.scans = indices_.size();
  summary.warnings = dataset_.warnings;
  if (detections_) warn_of_strange_boxes(dataset_, indices_, *detections_, summary);
  summary.boxes_from = boxes_from(detections_.has_value(), config_.detection.detector);
  const bool with_objects = detections_ || config_.detection.detector != Detector::none;
  std::error_code ignored;                         // what is wrong with the folder is met again below
  std::filesystem::remove(state_file(), ignored);  // of an earlier run, whose files are replaced now
  output_.emplace(options_.out, dataset_, config_, with_objects);
  write_file_atomically(options_.out / "config.yaml", to_yaml(config_));
}

bool Run::load() {
  const std::optional<std::string> state = read_checkpoint(state_file(), owner_);
  if (!state) return false;
  RunOutputState output;
  ArchiveReader(*state, state_file().string())(progress_, output, pipeline_);
  output_.emplace(options_.out, dataset_, config_, std::move(output));
  return true;
}

void Run::save() {
  if (saving_.valid()) saving_.get();
  ArchiveWriter state;
  state(progress_, output_->state(), pipeline_);
  saving_ = std::async(std::launch::async, [this, bytes = state.take()]() mutable {
    // What is captured would live until the next state is saved.
    const std::string own_bytes = std::move(bytes);
    write_checkpoint(state_file(), owner_, own_bytes);
  });
}

void Run::skip(const std::string& problem) {
  const std::size_t frame = dataset_.scans->frame(indices_[progress_.next]);
  RunSummary& summary = progress_.summary;
  if (progress_.first_problem.empty()) progress_.first_problem = problem;
  ++progress_.skipped_since;
  const double stamp_s = progress_.stamp_s + progress_.skipped_since * progress_.duration_s;
  output_->write_skipped(frame, stamp_s, problem, pipeline_.predict_poses(progress_.skipped_since));
  ++summary.skipped;
  if (summary.skipped <= kMaxListedProblems) {
    summary.warnings.push_back(fmt::format("scan {} was skipped: {}", frame, problem));
  }
}

void Run::process(const Scan& scan) {
  progress_.stamp_s = scan.stamp_s;
  progress_.duration_s = scan.duration_s;
  progress_.skipped_since = 0.0;
  if (!detections_ && progress_.summary.processed == 0) {
    for (std::string& problem : find_detector_problems(scan, config_, pipeline_.network())) {
      progress_.summary.warnings.push_back(std::move(problem));
    }
  }
  FrameResult result = detections_
                           ? pipeline_.process(scan, detections_->detections_at(scan.frame, scan.stamp_s))
                           : pipeline_.process(scan);
  tally(result, progress_.summary);
  const Eigen::Vector3d position = result.T_map_lidar.translation();
  output_->write(std::move(result));
  if (progress_.last_position) progress_.summary.path_m += (position - *progress_.last_position).norm();
  progress_.last_position = position;
}

void Run::take(const ScanReading& reading) {
  progress_.summary.invalid_points += reading.invalid_points;
  if (reading.scan) {
    process(*reading.scan);
  } else {
    skip(reading.problem);
  }
  ++progress_.next;
  if (progress_.save_map.is_due(progress_.next)) output_->write_map(pipeline_.static_map().points());
  if (progress_.save_state.is_due(progress_.next)) save();
}

void Run::take_all(const std::function<void(std::size_t, std::size_t)>& on_scan,
                   const std::function<bool()>& should_stop) {
  const auto read = [&](std::size_t i) {
    return std::async(std::launch::async, [&, i] { return dataset_.scans->read(indices_[i]); });
  };
  const std::size_t count = indices_.size();
  std::future<ScanReading> next;
  if (progress_.next < count) next = read(progress_.next);
  while (progress_.next < count) {
    const ScanReading reading = next.get();
    if (should_stop && should_stop()) {
      progress_.summary.interrupted = true;
      return;
    }
    if (progress_.next + 1 < count) next = read(progress_.next + 1);
    take(reading);
    if (on_scan) on_scan(progress_.next, count);
  }
}

// Where the robot came back to places, all results are moved accordingly. Half of them moved are nothing to
// go on from: a run that is killed here begins anew.
void Run::correct(RunSummary& summary, std::vector<MapPoint>& map) const {
  const SceneFile scene(options_.out / "scene.mlo");
  const ClosedLoops closed = close_loops(scene, config_);
  summary.loops = closed.loops;
  if (closed.loops == 0) return;
  std::map<std::size_t, SE3> by_frame;
  for (std::size_t i = 0; i < scene.num_scans(); ++i) by_frame[scene.scan(i).frame] = closed.corrections[i];
  map = pipeline_.static_map().moved_points(by_frame);
  std::filesystem::remove(state_file());
  move_results(options_.out, closed.corrections, map, dataset_.calibration.T_camera0_lidar, config_.scene);
}

// What is written once, at the end.
RunSummary Run::finish() {
  RunSummary summary = progress_.summary;
  if (summary.interrupted) {
    progress_.summary.interrupted = false;
    save();  // to go on from here
  }
  if (saving_.valid()) saving_.get();
  std::vector<MapPoint> map = pipeline_.static_map().points();
  output_->write_map(map);
  output_->write_object_trajectories();
  output_->write_object_maps(pipeline_.object_maps());
  output_->finish();
  if (config_.loop_closure.enabled && !summary.interrupted) correct(summary, map);
  summary.map_points = map.size();
  if (summary.skipped > kMaxListedProblems) {
    summary.warnings.push_back(fmt::format("{} more scans were skipped; per_scan.csv lists all",
                                           summary.skipped - kMaxListedProblems));
  }
  write_file_atomically(options_.out / "run.json", to_json(dataset_, config_, summary));
  if (!summary.interrupted) std::filesystem::remove(state_file());
  if (summary.processed == 0 && !summary.interrupted) {
    throw InputError(fmt::format("{}: none of the {} scans could be used; the first problem: {}",
                                 dataset_.root.string(), summary.scans, progress_.first_problem));
  }
  return summary;
}

}  // namespace

RunSummary run(const Dataset& dataset, const std::optional<DetectionList>& detections,
               const PipelineConfig& config, const RunOptions& options,
               const std::function<void(std::size_t, std::size_t)>& on_scan,
               const std::function<bool()>& should_stop) {
  Run run(dataset, detections, config, options);
  run.take_all(on_scan, should_stop);
  return run.finish();
}

}  // namespace mlo
