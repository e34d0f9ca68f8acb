#include "mlo/truth/detection_truth.hpp"

#include <algorithm>
#include <string>

#include "mlo/io/kitti_box.hpp"
#include "mlo/io/kitti_tracks.hpp"

namespace mlo {
namespace {

constexpr double kKittiFocal_px = 721.5;
constexpr std::size_t kMinPoints = 5;
constexpr double kFullyVisible = 0.75;
constexpr double kPartlyVisible = 0.35;
constexpr int kUnknownOcclusion = 3;

std::optional<double> height_in_image_px(const Box3d& box, const LabelledView& view) {
  const auto image = project_box(box_in_camera(box, view.T_camera0_lidar), view.P2, view.image_size_px);
  if (!image) return std::nullopt;
  return image->bottom_px - image->top_px;
}

int occlusion_of(const ObjectPose& object) {
  if (object.points.value_or(kMinPoints) < kMinPoints) return kUnknownOcclusion;
  const double share = object.visible_share.value_or(1.0);
  return share > kFullyVisible ? 0 : share > kPartlyVisible ? 1 : 2;
}

std::vector<ScoredBox> scored_boxes(std::span<const DetectionRecord> records,
                                    const std::optional<LabelledView>& view) {
  std::vector<ScoredBox> boxes;
  for (const DetectionRecord& record : records) {
    const Detection& detection = record.detection;
    const std::optional<double> height_px =
        view ? height_in_image_px(detection.box, *view) : height_all_round_px(detection.box);
    if (!height_px) continue;
    // not the confidence: logits of sure detections differ where these are all 1
    boxes.push_back(
        {std::string(to_string(detection.object_class)), detection.box, record.raw_score, *height_px});
  }
  return boxes;
}

}  // namespace

double height_all_round_px(const Box3d& box) {
  const double range_m = box.center_lidar_m.head<2>().norm();
  return kKittiFocal_px * box.size_lwh_m.z() / std::max(range_m, 1.0);
}

LabelledFrames labelled_boxes(std::span<const ObjectRecord> records, const SE3& T_camera0_lidar) {
  LabelledFrames frames;
  for (const ObjectRecord& record : records) {
    std::vector<LabelledBox>& frame = frames[record.frame];  // there, even if it holds no object
    if (record.track_id < 0) continue;
    frame.push_back({.type = record.type,
                     .box = box_in_lidar(kitti_box_of(record), T_camera0_lidar),
                     .height_px = record.image_box.bottom_px - record.image_box.top_px,
                     .occlusion = record.occlusion,
                     .truncation = record.truncation});
  }
  return frames;
}

LabelledFrames labelled_boxes(std::span<const ObjectPose> objects, const PoseList& poses) {
  std::map<std::size_t, SE3> T_lidar_map;
  LabelledFrames frames;
  for (std::size_t i = 0; i < poses.frames.size(); ++i) {
    T_lidar_map.emplace(poses.frames[i], poses.T_world_body[i].inverse());
    frames[poses.frames[i]];
  }
  for (const ObjectPose& object : objects) {
    const auto pose = T_lidar_map.find(object.frame);
    if (pose == T_lidar_map.end()) continue;
    LabelledBox label;
    label.type = object.type;
    label.box = upright_box(pose->second * object.T_map_object, object.size_lwh_m);
    label.height_px = height_all_round_px(label.box);
    label.occlusion = occlusion_of(object);
    frames[object.frame].push_back(std::move(label));
  }
  return frames;
}

std::vector<DetectionFrame> detection_frames(const LabelledFrames& truth, const DetectionList& detections,
                                             const std::optional<LabelledView>& view) {
  std::vector<DetectionFrame> frames;
  if (truth.empty()) return frames;
  for (std::size_t i = truth.begin()->first; i <= truth.rbegin()->first; ++i) {
    DetectionFrame frame;
    if (const auto labels = truth.find(i); labels != truth.end()) frame.truth = labels->second;
    const auto records = detections.by_frame.find(i);
    if (records != detections.by_frame.end()) frame.detections = scored_boxes(records->second, view);
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace mlo
