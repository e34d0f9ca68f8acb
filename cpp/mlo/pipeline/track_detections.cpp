#include "mlo/pipeline/track_detections.hpp"

#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/kitti_box.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/io/trajectory_file.hpp"

namespace mlo {
namespace {

std::map<std::size_t, SE3> poses_by_frame(const PoseList& poses) {
  std::map<std::size_t, SE3> by_frame;
  for (std::size_t i = 0; i < poses.frames.size(); ++i)
    by_frame.emplace(poses.frames[i], poses.T_world_body[i]);
  return by_frame;
}

std::vector<Detection> detections_at(const DetectionList& list, std::size_t frame, double stamp_s) {
  std::vector<Detection> detections;
  for (const DetectionRecord& record : list.at(frame, stamp_s)) detections.push_back(record.detection);
  return detections;
}

std::size_t frame_count(const DetectionList& list, double scan_interval_s) {
  if (!list.by_frame.empty()) return list.by_frame.rbegin()->first + 1;
  if (list.by_stamp_s.empty()) return 0;
  return static_cast<std::size_t>(std::lround(list.by_stamp_s.rbegin()->first / scan_interval_s)) + 1;
}

std::string csv_row(const FrameTracks& frame, const TrackedObject& object) {
  const Eigen::Vector3d& p = object.T_odom_object.translation();
  const Eigen::Vector3d rotation = so3_log(object.T_odom_object.rotation());
  const Eigen::Vector4d sd = object.planar_covariance.diagonal().cwiseSqrt();
  const Box3d& box = object.box;
  return fmt::format(
      "{},{:.6f},{},{},{},{:.4f},{:.4f},{:.4f},{:.5f},{:.3f},{:.3f},{:.4f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}"
      ","
      "{:.3f},{:.3f},{:.3f},{:.4f},{:.4f},{:.4f},{:.5f},{:.2f},{},{}\n",
      frame.frame, frame.stamp_s, object.id, to_string(object.object_class), to_string(object.state), p.x(),
      p.y(), p.z(), rotation.z(), object.velocity_odom_mps.x(), object.velocity_odom_mps.y(),
      object.turn_rate_radps, object.moving_probability, sd(0), sd(1), sd(2), sd(3), box.size_lwh_m.x(),
      box.size_lwh_m.y(), box.size_lwh_m.z(), box.center_lidar_m.x(), box.center_lidar_m.y(),
      box.center_lidar_m.z(), box.yaw_rad, object.existence, object.hits, object.misses);
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
    const std::vector<Detection> seen = detections_at(detections, frame, stamp_s);
    FrameTracks result;
    result.frame = frame;
    result.stamp_s = stamp_s;
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
    result.T_odom_lidar = tracker.T_odom_lidar();
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
                         .score = 1.0 / (1.0 + std::exp(-object.existence))});
    }
  }
  return records;
}

void write_objects_csv(const std::filesystem::path& path, std::span<const FrameTracks> frames) {
  std::string text =
      "frame,stamp_s,id,class,state,x_odom_m,y_odom_m,z_odom_m,yaw_odom_rad,vx_odom_mps,vy_odom_mps,turn_"
      "rate_radps,"
      "moving_probability,sd_x_m,sd_y_m,sd_vx_mps,sd_vy_mps,length_m,width_m,height_m,x_lidar_m,y_lidar_m,z_"
      "lidar_m,"
      "yaw_lidar_rad,existence,hits,misses\n";
  for (const FrameTracks& frame : frames) {
    for (const TrackedObject& object : frame.objects) {
      if (object.reported) text += csv_row(frame, object);
    }
  }
  write_file_atomically(path, text);
}

void write_object_trajectories(const std::filesystem::path& folder, std::span<const FrameTracks> frames) {
  std::map<long, PoseList> trajectories;
  for (const FrameTracks& frame : frames) {
    for (const TrackedObject& object : frame.objects) {
      if (!object.reported) continue;
      PoseList& poses = trajectories[object.id];
      poses.frames.push_back(frame.frame);
      poses.stamps_s.push_back(frame.stamp_s);
      poses.T_world_body.push_back(object.T_odom_object);
    }
  }
  std::filesystem::create_directories(folder);
  for (const auto& [id, poses] : trajectories) write_tum_poses(folder / fmt::format("{:05}.txt", id), poses);
}

}  // namespace mlo
