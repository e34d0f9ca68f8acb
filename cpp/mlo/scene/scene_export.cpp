#include "mlo/scene/scene_export.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/core/voxel_grid.hpp"
#include "mlo/scene/foxglove.hpp"
#include "mlo/scene/mcap_writer.hpp"

namespace mlo {
namespace {

constexpr int kMcapCompressionLevel = 3;

const SceneObject* find(const SceneScan& scan, long id) {
  const auto found = std::find_if(scan.objects.begin(), scan.objects.end(),
                                  [&](const SceneObject& object) { return object.id == id; });
  return found == scan.objects.end() ? nullptr : &*found;
}

[[noreturn]] void fail_without_object(const SceneFile& scene, long id) {
  throw InputError(fmt::format("{}: no scan has an object {}; 'mlo export --format csv' lists all",
                               scene.path().string(), id));
}

SceneCloud to_cloud(const std::vector<MapPoint>& points) {
  SceneCloud cloud;
  for (const MapPoint& point : points) cloud.add({point.p_map, point.intensity}, point.label);
  return cloud;
}

// Ids of the first that are not in the second.
std::vector<long> missing(const std::vector<SceneObject>& before, const SceneScan& now) {
  std::vector<long> ids;
  for (const SceneObject& object : before) {
    if (find(now, object.id) == nullptr) ids.push_back(object.id);
  }
  return ids;
}

}  // namespace

std::vector<ObjectPose> object_poses(const SceneFile& scene) {
  std::vector<ObjectPose> rows;
  for (std::size_t i = 0; i < scene.num_scans(); ++i) {
    const SceneScan scan = scene.scan(i);
    for (const SceneObject& object : scan.objects) {
      rows.push_back({.frame = scan.frame,
                      .stamp_s = scan.stamp_s,
                      .id = object.id,
                      .type = std::string(to_string(object.object_class)),
                      .state = object.moving ? "moving" : "at_rest",
                      .T_map_object = object.T_map_object,
                      .size_lwh_m = object.size_lwh_m,
                      .points = object.num_points});
    }
  }
  return rows;
}

PoseList object_trajectory(const SceneFile& scene, long id) {
  PoseList poses;
  for (std::size_t i = 0; i < scene.num_scans(); ++i) {
    const SceneScan scan = scene.scan(i);
    const SceneObject* object = find(scan, id);
    if (object == nullptr) continue;
    poses.frames.push_back(scan.frame);
    poses.stamps_s.push_back(scan.stamp_s);
    poses.T_world_body.push_back(object->T_map_object);
  }
  if (poses.frames.empty()) fail_without_object(scene, id);
  return poses;
}

std::vector<MapPoint> object_cloud(const SceneFile& scene, long id, double voxel_m) {
  std::vector<MapPoint> points;
  const auto thinned = [&] {
    return downsample_first<MapPoint>(points, static_cast<float>(voxel_m),
                                      [](const MapPoint& point) { return point.p_map; });
  };
  for (const ScenePoint& point : scene.object(id).points) {
    points.push_back({point.p, point.intensity, MapLabel::object});
  }
  if (!points.empty()) return thinned();
  bool seen = false;
  for (std::size_t i = 0; i < scene.num_scans(); ++i) {
    const SceneScan scan = scene.scan(i);
    const SceneObject* object = find(scan, id);
    if (object == nullptr) continue;
    seen = true;
    const SE3 T_object_lidar = object->T_map_object.inverse() * scan.T_map_lidar;
    for_each_point(scene.cloud(i), [&](const ScenePoint& point, const PointGroup& group) {
      if (group.label != MapLabel::object || group.object != id) return;
      points.push_back(
          {(T_object_lidar * point.p.cast<double>()).cast<float>(), point.intensity, group.label});
    });
  }
  if (!seen) fail_without_object(scene, id);
  return thinned();
}

void export_mcap(const SceneFile& scene, const std::filesystem::path& path) {
  McapWriter writer(path, kMcapCompressionLevel);
  const auto add = [&](const char* topic, const char* schema) {
    return writer.add_channel(topic, std::string("foxglove.") + schema, foxglove::schema(schema));
  };
  const McapWriter::Channel transforms = add("/tf", "FrameTransforms");
  const McapWriter::Channel pose = add("/pose", "PoseInFrame");
  const McapWriter::Channel trajectory = add("/trajectory", "PosesInFrame");
  const McapWriter::Channel points = add("/points", "PointCloud");
  const McapWriter::Channel objects = add("/objects", "SceneUpdate");
  const McapWriter::Channel map = add("/map", "PointCloud");
  const McapWriter::Channel shapes = add("/object_clouds", "PointCloud");
  if (scene.num_scans() > 0) {
    const double start_s = scene.stamp_s(0);
    const std::uint64_t start_ns = foxglove::to_ns(start_s);
    writer.write(trajectory, start_ns,
                 foxglove::poses_in_frame(robot_poses(scene).T_world_body, "map", start_s));
    writer.write(map, start_ns, foxglove::point_cloud(to_cloud(scene.map()), "map", start_s));
  }
  std::vector<SceneObject> before;
  std::set<long> known;
  for (std::size_t i = 0; i < scene.num_scans(); ++i) {
    SceneScan scan = scene.scan(i);
    const std::uint64_t stamp_ns = foxglove::to_ns(scan.stamp_s);
    writer.write(transforms, stamp_ns, foxglove::frame_transforms(scan));
    writer.write(pose, stamp_ns, foxglove::pose_in_frame(scan.T_map_lidar, "map", scan.stamp_s));
    writer.write(objects, stamp_ns, foxglove::scene_update(scan, missing(before, scan)));
    for (const SceneObject& object : scan.objects) {
      const bool is_new = known.insert(object.id).second;
      const SceneCloud shape = is_new ? scene.object(object.id) : SceneCloud();
      if (shape.points.empty()) continue;
      writer.write(shapes, stamp_ns,
                   foxglove::point_cloud(shape, foxglove::object_frame(object.id), scan.stamp_s));
    }
    const SceneCloud cloud = scene.cloud(i);
    if (!cloud.points.empty())
      writer.write(points, stamp_ns, foxglove::point_cloud(cloud, "lidar", scan.stamp_s));
    before = std::move(scan.objects);
  }
  writer.finish();
}

}  // namespace mlo
