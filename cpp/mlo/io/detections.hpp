#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/io/dataset.hpp"

namespace mlo {

/// A detection and what its file says beside.
struct DetectionRecord {
  Detection detection;
  double raw_score = 1.0;             ///< as in the file, a logit or a confidence; 1 where it has none
  std::optional<Box2d> image_box_px;  ///< as the detector saw it in image 2
  std::optional<double> alpha_rad;    ///< KITTI's observation angle
};

/// Detections of a sequence, by frame or by stamp, as the file has them.
struct DetectionList {
  std::map<std::size_t, std::vector<DetectionRecord>> by_frame;
  std::map<double, std::vector<DetectionRecord>> by_stamp_s;  ///< one of the two maps is empty
  double stamp_tolerance_s = 0.0;

  /// The detections of a scan: those of its frame, or those of the nearest stamp within the tolerance.
  /// In the order of the files; empty when there are none. Valid as long as the list lives.
  std::span<const DetectionRecord> at(std::size_t frame, double stamp_s) const;
  /// The same without what the files say beside the boxes.
  std::vector<Detection> detections_at(std::size_t frame, double stamp_s) const;
  std::size_t count() const;
};

enum class ScoreKind {
  automatic,   ///< logits if any score of the file or folder lies outside [0, 1], else confidences
  confidence,  ///< in [0, 1] already
  logit        ///< the logistic function makes them confidences
};

struct DetectionOptions {
  std::string sequence{};  ///< picks the file where a folder has one for each sequence
  ScoreKind scores = ScoreKind::automatic;
  double stamp_tolerance_s = 0.05;  ///< half of a sweep at 10 Hz
};

/// Reads detections into the lidar frame. The format is recognised from the content of a file:
///   - AB3DMOT: frame,type,x1,y1,x2,y2,score,h,w,l,x,y,z,ry,alpha (type 1 pedestrian, 2 car, 3 cyclist)
///   - KITTI tracking labels and results, KITTI object labels and results (one file per frame)
///   - frame class truncated occluded alpha x1 y1 x2 y2 h w l x y z ry score (Point-GNN's trackers)
///   - JSON and CSV in the lidar frame (docs/detections.md)
/// A path may be a file, a folder with a file per frame or per sequence, or a folder of such folders, one per
/// class. Several paths are merged. Regions that KITTI marks DontCare are left out; labels have confidence 1.
/// @param calibration  needed for KITTI's boxes, which are in the camera's frame
/// @throws InputError with file and line; also when two of the paths have the same class, which is most
/// likely
///   two detectors at once
DetectionList read_detections(const std::vector<std::filesystem::path>& paths, const Calibration& calibration,
                              const DetectionOptions& options = {});

/// Header and lines of the project's own CSV (docs/detections.md), with line ends. Scores have twelve digits:
/// sure ones differ late.
std::string detection_csv_header();
std::string detection_csv_lines(std::size_t frame, std::span<const Detection> detections);

}  // namespace mlo
