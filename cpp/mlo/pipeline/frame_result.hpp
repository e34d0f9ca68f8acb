#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string_view>
#include <vector>

#include "mlo/core/ego_motion.hpp"
#include "mlo/core/features.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/core/sweep_motion.hpp"
#include "mlo/mapping/trajectory_list.hpp"
#include "mlo/mapping/unknown_movers.hpp"
#include "mlo/odometry/consistency_check.hpp"
#include "mlo/tracking/tracker.hpp"

namespace mlo {

/// The steps of a scan, in order.
enum class Stage { prepare, perception, detection, odometry, refinement, tracking, map_update };
inline constexpr std::size_t kNumStages = 7;
inline constexpr std::array<std::string_view, kNumStages> kStageNames{
    "prepare", "perception", "detection", "odometry", "refinement", "tracking", "map_update"};

/// Wall time per stage [ms].
struct StageTimes {
  std::array<double, kNumStages> ms{};

  double& operator[](Stage stage) { return ms[static_cast<std::size_t>(stage)]; }
  static void archive(auto& self, auto& bytes) { bytes(self.ms); }  // core/archive.hpp
  double total_ms() const {
    double sum = 0.0;
    for (const double value : ms) sum += value;
    return sum;
  }
};

/// Runs `work` and adds its wall time to a stage.
template <class Work>
auto timed(StageTimes& times, Stage stage, const Work& work) {
  struct Stopwatch {
    StageTimes& times;
    Stage stage;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    ~Stopwatch() {
      const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
      times[stage] += elapsed.count();
    }
  };
  const Stopwatch stopwatch{times, stage};
  return work();
}

/// Numbers of what perception found.
struct PerceptCounts {
  std::size_t points = 0;  ///< after cropping
  std::size_t ground_points = 0;
  std::size_t ground_features = 0;
  std::size_t edge_features = 0;
  std::size_t surface_features = 0;
  std::size_t candidates = 0;
  std::size_t objects = 0;
  std::size_t object_points = 0;
  std::size_t ambiguous_points = 0;
};

/// Everything that one scan brought: what viewers, files and metrics need.
struct FrameResult {
  std::size_t frame = 0;
  double stamp_s = 0.0;
  SE3 T_odom_lidar;         ///< T_ol: accumulated scan-to-scan odometry, at the stamp
  SE3 T_map_lidar;          ///< T_ml: after map refinement, at the stamp
  bool first = false;       ///< the first scan defines both frames
  PoseEstimate odometry;    ///< increment T_previous_current
  PoseEstimate refinement;  ///< T_map_lidar at the reference time of the sweep
  ConsistencyReport consistency;
  std::vector<TrackedObject> objects;  ///< all tracks that live, in the map frame; none without detections
  std::vector<UnknownMover> unknown_movers;    ///< what moves besides
  std::vector<MappedObject> finished_objects;  ///< maps of those that are no longer followed
  Percept percept;                             ///< what was seen, as measured
  SweepMotion motion = SweepMotion::none();    ///< brings its points to the reference time
  SE3 T_reference_stamp;                       ///< the lidar at the stamp, in its frame at the reference time
  PerceptCounts counts;
  StageTimes times;

  /// False: the pose is a prediction only.
  bool localised() const { return first || refinement.usable(); }
};

/// Where the lidar should be by constant motion, for scans that are missing.
struct PredictedPoses {
  SE3 T_odom_lidar;
  SE3 T_map_lidar;
};

}  // namespace mlo
