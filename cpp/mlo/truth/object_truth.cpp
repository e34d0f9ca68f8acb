#include "mlo/truth/object_truth.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "mlo/io/kitti_box.hpp"
#include "mlo/io/kitti_tracks.hpp"

namespace mlo {

std::vector<ObjectPose> objects_in_map(std::span<const ObjectRecord> records, const PoseList& poses,
                                       const SE3& T_camera0_lidar) {
  std::map<std::size_t, std::size_t> index_of_frame;
  for (std::size_t i = 0; i < poses.frames.size(); ++i) index_of_frame.emplace(poses.frames[i], i);
  std::vector<ObjectPose> objects;
  for (const ObjectRecord& record : records) {
    const auto found = index_of_frame.find(record.frame);
    if (record.track_id < 0 || found == index_of_frame.end()) continue;
    const std::size_t index = found->second;
    const Box3d box_lidar = box_in_lidar(kitti_box_of(record), T_camera0_lidar);
    ObjectPose object;
    object.frame = record.frame;
    if (index < poses.stamps_s.size()) object.stamp_s = poses.stamps_s[index];
    object.id = record.track_id;
    object.type = record.type;
    object.T_map_object = poses.T_world_body[index] * box_lidar.T_lidar_object();
    object.size_lwh_m = box_lidar.size_lwh_m;
    objects.push_back(std::move(object));
  }
  std::stable_sort(objects.begin(), objects.end(), [](const ObjectPose& a, const ObjectPose& b) {
    return std::tie(a.frame, a.id) < std::tie(b.frame, b.id);
  });
  return objects;
}

}  // namespace mlo
