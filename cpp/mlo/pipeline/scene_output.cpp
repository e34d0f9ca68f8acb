#include "mlo/pipeline/scene_output.hpp"

#include <utility>

#include "mlo/core/voxel_grid.hpp"

namespace mlo {
namespace {

SceneObject scene_object(const TrackedObject& object) {
  return {.id = object.id,
          .object_class = object.object_class,
          .detected = object.detection.has_value(),
          .moving = object.moving,
          .moving_probability = object.moving_probability,
          .existence = object.existence,
          .num_points = static_cast<std::uint32_t>(object.num_points),
          .T_map_object = object.T_map_object,
          .size_lwh_m = object.box.size_lwh_m,
          .velocity_map_mps = object.velocity_map_mps,
          .turn_rate_radps = object.turn_rate_radps,
          .planar_covariance = object.planar_covariance,
          .yaw_covariance = object.yaw_covariance};
}

ScanStatus status_of(const FrameResult& result) {
  if (result.first) return ScanStatus::first;
  return result.localised() ? ScanStatus::localised : ScanStatus::predicted;
}

// The track that each detection of the scan belongs to; 0 where none is reported.
std::vector<long> tracks_of_detections(const FrameResult& result) {
  std::vector<long> ids(result.percept.objects.size(), 0);
  for (const TrackedObject& object : result.objects) {
    if (object.reported && object.detection) ids.at(*object.detection) = object.id;
  }
  return ids;
}

struct LabelledFeature {
  const FeaturePoint* point;
  MapLabel label;
};

std::vector<LabelledFeature> thinned_environment(const Percept& percept, double voxel_m) {
  std::vector<LabelledFeature> all;
  const auto append = [&](const FeatureSet& set, MapLabel label) {
    for (const FeaturePoint& point : set.candidates) all.push_back({&point, label});
  };
  append(percept.edge, MapLabel::edge);
  append(percept.ground, MapLabel::ground);
  append(percept.surface, MapLabel::surface);
  return downsample_first<LabelledFeature>(
      all, static_cast<float>(voxel_m),
      [](const LabelledFeature& feature) { return feature.point->p_lidar; });
}

}  // namespace

SceneScan scene_scan(const FrameResult& result) {
  SceneScan scan{.frame = result.frame, .stamp_s = result.stamp_s, .status = status_of(result)};
  scan.T_map_lidar = result.T_map_lidar;
  scan.T_odom_lidar = result.T_odom_lidar;
  scan.covariance = result.refinement.covariance;
  scan.odometry = result.odometry.status;
  scan.refinement = result.refinement.status;
  scan.degenerate_directions = result.refinement.degenerate_directions;
  scan.num_matches = result.refinement.num_matches;
  for (const TrackedObject& object : result.objects) {
    if (object.reported) scan.objects.push_back(scene_object(object));
  }
  return scan;
}

SceneCloud scene_cloud(const FrameResult& result, double voxel_m) {
  const SE3 T_stamp_reference = result.T_reference_stamp.inverse();
  const auto at_stamp = [&](const auto& point) {
    const Eigen::Vector3d p_reference = result.motion.undistort(point.p_lidar.template cast<double>(),
                                                                static_cast<double>(point.sweep_fraction));
    return ScenePoint{(T_stamp_reference * p_reference).cast<float>(), point.intensity};
  };
  SceneCloud cloud;
  for (const LabelledFeature& feature : thinned_environment(result.percept, voxel_m)) {
    cloud.add(at_stamp(*feature.point), feature.label);
  }
  const std::vector<long> tracks = tracks_of_detections(result);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (const Point& point : result.percept.objects[i].points) {
      cloud.add(at_stamp(point), MapLabel::object, tracks[i]);
    }
  }
  return cloud;
}

SceneOutput::SceneOutput(const std::filesystem::path& file, const SceneMeta& meta, const SceneConfig& config)
    : config_(config), writer_(file, meta, config) {}

SceneOutput::SceneOutput(const std::filesystem::path& file, SceneWriterState state, const SceneConfig& config)
    : config_(config), writer_(file, std::move(state), config) {}

SceneWriterState SceneOutput::state() {
  wait();
  return writer_.state();
}

void SceneOutput::wait() {
  if (writing_.valid()) writing_.get();
}

void SceneOutput::write(FrameResult result) {
  wait();
  writing_ = std::async(std::launch::async, [this, result = std::move(result)] {
    const SceneCloud cloud = config_.clouds ? scene_cloud(result, config_.cloud_voxel_m) : SceneCloud();
    writer_.write(scene_scan(result), &cloud);
  });
}

void SceneOutput::write_skipped(std::size_t frame, double stamp_s, const std::string& problem,
                                const PredictedPoses& predicted) {
  wait();
  SceneScan scan{.frame = frame, .stamp_s = stamp_s, .status = ScanStatus::skipped, .problem = problem};
  scan.T_map_lidar = predicted.T_map_lidar;
  scan.T_odom_lidar = predicted.T_odom_lidar;
  writer_.write(scan, nullptr);
}

void SceneOutput::write_map(std::span<const MapPoint> points) {
  wait();
  writer_.write_map(points);
}

void SceneOutput::write_object(const MappedObject& object) {
  wait();
  SceneCloud cloud;
  for (const Eigen::Vector3f& p : object.points_object) cloud.add({p, 0.0F}, MapLabel::object, object.id);
  writer_.write_object(object.id, cloud);
}

void SceneOutput::finish() {
  wait();
  writer_.finish();
}

}  // namespace mlo
