#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mlo/io/dataset.hpp"
#include "mlo/io/detections.hpp"
#include "mlo/pipeline/config.hpp"
#include "mlo/pipeline/frame_result.hpp"
#include "mlo/pipeline/start_in_map.hpp"

namespace mlo {

struct RunOptions {
  std::filesystem::path out;
  std::size_t first_frame = 0;  ///< frame numbers, both ends included
  std::size_t last_frame = static_cast<std::size_t>(-1);
  std::size_t checkpoint_scans = 500;  ///< the static map is saved this often, 0 only at the end
  std::size_t state_scans = 100;       ///< what resume goes on from is saved this often, 0 never
  /// Goes on where a run of the same scans and configuration with the same folder was last saved; from the
  /// first scan where there is nothing to go on from.
  bool resume = false;
  std::optional<StartInMap> map = {};  ///< to localise in; none: a map is made
};

/// What a run did; written to run.json.
struct RunSummary {
  std::size_t scans = 0;  ///< that should have been there
  std::size_t processed = 0;
  std::size_t skipped = 0;
  std::size_t predicted = 0;            ///< processed, but too few matches: the pose is a prediction
  std::size_t degenerate = 0;           ///< scans that left a direction to the prediction in the refinement
  std::size_t odometry_degenerate = 0;  ///< and in the odometry
  std::size_t failed_checks = 0;        ///< consistency checks without a set that passed
  std::size_t invalid_points = 0;
  std::size_t detections = 0;
  std::string boxes_from = "none";  ///< given, or the detector that found them
  double path_m = 0.0;
  std::size_t map_points = 0;
  std::size_t loops = 0;  ///< that were closed at the end
  bool interrupted = false;
  std::vector<StageTimes> times;      ///< one per processed scan
  std::vector<std::string> warnings;  ///< one sentence each

  static void archive(auto& self, auto& bytes) {  // core/archive.hpp
    bytes(self.scans, self.processed, self.skipped, self.predicted, self.degenerate, self.odometry_degenerate,
          self.failed_checks, self.invalid_points, self.detections, self.boxes_from, self.path_m,
          self.map_points, self.loops, self.interrupted, self.times, self.warnings);
  }
};

/// Runs the pipeline over a data set and writes its results; the next scan is read while one is computed.
/// @param detections   boxes by frame; none: the detector of the configuration looks for objects
/// @param on_scan      called after each scan with the number done and the number in total; may be empty
/// @param should_stop  asked before each scan; true ends the run early with everything written
/// @throws InputError when no scan can be used, the results cannot be written, or resume finds the state of a
/// run of other scans or another configuration
RunSummary run(const Dataset& dataset, const std::optional<DetectionList>& detections,
               const PipelineConfig& config, const RunOptions& options,
               const std::function<void(std::size_t, std::size_t)>& on_scan,
               const std::function<bool()>& should_stop);

}  // namespace mlo
