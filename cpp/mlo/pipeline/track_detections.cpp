#include "mlo/pipeline/track_detections.hpp"

#include <chrono>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/core/log_odds.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/kitti_box.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/pipeline/object_table.hpp"

namespace mlo {
namespace {

std::map<std::size_t, SE3> poses_by_frame(const PoseList& poses) {
  std::map<std::size_t, SE3> by_frame;
  for (std::size_t i = 0; i < poses.frames.size(); ++i)
    by_frame.emplace(poses.frames[i], poses.T_world_body[i]);
  return by_frame;
}

std::size_t frame_count(const DetectionList& list, double scan_interval_s) {
  if (!list.by_frame.empty()) return list.by_frame.rbegin()->first + 1;
  if (list.by_stamp_s.empty()) return 0;
  return static_cast<std::size_t>(std::lround(list.by_stamp_s.rbegin()->first / scan_interval_s)) + 1;
}

}  // namespace

double CameraView::width_deg() const {
  return 2.0 * std::atan(0.5 * image_size_px.x() / P2(0, 0)) * 180.0 / std::numbers::pi;
}

std::vector<FrameTracks> track_detections(const DetectionList& detections,
                                          const std::optional<PoseList>& T_world_lidar,
                                          double scan_interval_s, const TrackingConfig& config) {
  std::map<std::size_t, SE3> poses;
  if (T_world_lidar) poses = poses_by_frame(*T_world_lidar);
  Tracker tracker(config);
  std::vector<FrameTracks> frames;
  const std::size_t count = frame_count(detections, scan_interval_s);
  for (std::size_t frame = 0; frame < count; ++frame) {
    const double stamp_s = static_cast<double>(frame) * scan_interval_s;
    const std::vector<Detection> seen = detections.detections_at(frame, stamp_s);
    FrameTracks result;
    result.frame = frame;
    result.stamp_s = stamp_s;
    const auto start = std::chrono::steady_clock::now();
    if (T_world_lidar) {
      const auto pose = poses.find(frame);
      if (pose == poses.end()) {
        throw InputError(
            fmt::format("frame {} has detections up to frame {} but no pose; give poses of all frames, "
                        "or none",
                        frame, count - 1));
      }
      result.objects = tracker.process(seen, pose->second, scan_interval_s);
    } else {
      result.objects = tracker.process(seen, scan_interval_s);
    }
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    result.tracking_ms = elapsed.count();
    result.T_map_lidar = tracker.T_map_lidar();
    frames.push_back(std::move(result));
  }
  return frames;
}

std::vector<ObjectRecord> kitti_records(std::span<const FrameTracks> frames, const CameraView& view) {
  std::vector<ObjectRecord> records;
  for (const FrameTracks& frame : frames) {
    for (const TrackedObject& object : frame.objects) {
      if (!object.reported) continue;
      const KittiBox box = box_in_camera(object.box, view.T_camera0_lidar);
      const auto image_box = project_box(box, view.P2, view.image_size_px);
      if (!image_box) continue;
      records.push_back({.frame = frame.frame,
                         .track_id = object.id,
                         .type = std::string(to_string(object.object_class)),
                         .image_box = *image_box,
                         .box = box_in_lidar(box, T_camera0_level()),
                         .score = probability(object.belief)});
    }
  }
  return records;
}

void write_object_table(const std::filesystem::path& path, std::span<const FrameTracks> frames) {
  std::string text = object_table_header() + "\n";
  for (const FrameTracks& frame : frames) {
    for (const TrackedObject& object : frame.objects) {
      if (object.reported) text += object_table_row({frame.frame, frame.stamp_s}, object) + "\n";
    }
  }
  write_file_atomically(path, text);
}

void write_object_trajectories(const std::filesystem::path& folder, std::span<const FrameTracks> frames) {
  ObjectTrajectories trajectories;
  for (const FrameTracks& frame : frames) {
    for (const TrackedObject& object : frame.objects) {
      if (object.reported) trajectories.add({frame.frame, frame.stamp_s}, object.id, object.T_map_object);
    }
  }
  trajectories.write(folder);
}

}  // namespace mlo
