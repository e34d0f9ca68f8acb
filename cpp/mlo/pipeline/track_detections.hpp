#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "mlo/core/object_record.hpp"
#include "mlo/io/detections.hpp"
#include "mlo/tracking/tracker.hpp"

namespace mlo {

/// All tracks that live after a scan.
struct FrameTracks {
  std::size_t frame = 0;
  double stamp_s = 0.0;
  SE3 T_map_lidar;
  std::vector<TrackedObject> objects;
  double tracking_ms = 0.0;  ///< wall time of the tracker
};

/// Tracks of a sequence from boxes and poses alone, on line, for every frame from 0 to the last with a
/// detection.
/// @param T_world_lidar  poses of the lidar, or nothing: the tracker then estimates its motion from the boxes
/// @param scan_interval_s  time between frames
/// @throws InputError when a frame has no pose
std::vector<FrameTracks> track_detections(const DetectionList& detections,
                                          const std::optional<PoseList>& T_world_lidar,
                                          double scan_interval_s, const TrackingConfig& config);

/// What an image needs to show boxes.
struct CameraView {
  SE3 T_camera0_lidar;  ///< rectified camera 0
  Eigen::Matrix<double, 3, 4> P2 = Eigen::Matrix<double, 3, 4>::Zero();
  Eigen::Vector2d image_size_px{1242.0, 375.0};

  /// Full horizontal angle of view [deg].
  double width_deg() const;
};

/// The reported tracks as the KITTI tracking benchmark has them: those in the image, with their projections.
std::vector<ObjectRecord> kitti_records(std::span<const FrameTracks> frames, const CameraView& view);

/// objects.csv (object_table.hpp) of the reported tracks; the map frame is that of the poses.
/// @throws InputError when the file cannot be written
void write_object_table(const std::filesystem::path& path, std::span<const FrameTracks> frames);

/// A TUM file (NNNNN.txt) per track that was reported, of its poses in the map frame.
/// @throws InputError when one cannot be written
void write_object_trajectories(const std::filesystem::path& folder, std::span<const FrameTracks> frames);

}  // namespace mlo
