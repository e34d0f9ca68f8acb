#pragma once

#include <filesystem>
#include <future>
#include <span>
#include <string>

#include "mlo/pipeline/frame_result.hpp"
#include "mlo/scene/scene_writer.hpp"

namespace mlo {

/// What a scan adds to the scene: the robot's pose and the objects that are reported.
SceneScan scene_scan(const FrameResult& result);

/// What it saw, without distortion, in the lidar frame at its stamp: the candidates of the environment
/// thinned to one point per voxel, edges first, then all points of the objects with the tracks that they
/// belong to.
SceneCloud scene_cloud(const FrameResult& result, double voxel_m);

/// Writes scene.mlo beside the run: a scan is brought into the file while the next one is computed.
class SceneOutput {
 public:
  /// @throws InputError when the file cannot be written; so do the calls below, also for the scan before
  SceneOutput(const std::filesystem::path& file, const SceneMeta& meta, const SceneConfig& config);

  /// Goes on with a scene where an output was; what the file has beyond that is cut off.
  SceneOutput(const std::filesystem::path& file, SceneWriterState state, const SceneConfig& config);

  void write(FrameResult result);
  /// @param stamp_s  when the scan should have been taken
  void write_skipped(std::size_t frame, double stamp_s, const std::string& problem,
                     const PredictedPoses& predicted);
  void write_map(std::span<const MapPoint> points);
  void write_object(const MappedObject& object);
  void finish();
  /// Until all that was given is in the file.
  void wait();
  /// With all that was given so far.
  SceneWriterState state();

 private:
  SceneConfig config_;
  SceneWriter writer_;
  std::future<void> writing_;  // declared last: what it uses lives longer
};

}  // namespace mlo
