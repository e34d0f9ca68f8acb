#include "mlo/scene/foxglove.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mlo/core/archive.hpp"
#include "mlo/core/bytes.hpp"

namespace mlo::foxglove {
namespace {

using nlohmann::ordered_json;

constexpr std::uint64_t kNanosecondsPerSecond = 1'000'000'000;
// Of PackedElementField.
constexpr int kUint8 = 1;
constexpr int kFloat32 = 7;

// --- schemas
// ---------------------------------------------------------------------------------------------------

ordered_json of_type(const char* type) {
  return {{"type", type}};
}

ordered_json object(const char* title, ordered_json properties) {
  return {{"title", title}, {"type", "object"}, {"properties", std::move(properties)}};
}

ordered_json list_of(ordered_json items) {
  return {{"type", "array"}, {"items", std::move(items)}};
}

ordered_json time_schema(const char* title) {
  return object(title,
                {{"sec", {{"type", "integer"}, {"minimum", 0}}},
                 {"nsec", {{"type", "integer"}, {"minimum", 0}, {"maximum", kNanosecondsPerSecond - 1}}}});
}

ordered_json numbers_schema(const char* title, std::initializer_list<const char*> names) {
  ordered_json properties;
  for (const char* name : names) properties[name] = of_type("number");
  return object(title, properties);
}

ordered_json vector_schema() {
  return numbers_schema("foxglove.Vector3", {"x", "y", "z"});
}

ordered_json rotation_schema() {
  return numbers_schema("foxglove.Quaternion", {"x", "y", "z", "w"});
}

ordered_json pose_schema() {
  return object("foxglove.Pose", {{"position", vector_schema()}, {"orientation", rotation_schema()}});
}

ordered_json color_schema() {
  return numbers_schema("foxglove.Color", {"r", "g", "b", "a"});
}

ordered_json point_cloud_schema() {
  const ordered_json field =
      object("foxglove.PackedElementField",
             {{"name", of_type("string")}, {"offset", of_type("integer")}, {"type", of_type("integer")}});
  return object("foxglove.PointCloud", {{"timestamp", time_schema("time")},
                                        {"frame_id", of_type("string")},
                                        {"pose", pose_schema()},
                                        {"point_stride", of_type("integer")},
                                        {"fields", list_of(field)},
                                        {"data", {{"type", "string"}, {"contentEncoding", "base64"}}}});
}

ordered_json frame_transforms_schema() {
  const ordered_json transform = object("foxglove.FrameTransform", {{"timestamp", time_schema("time")},
                                                                    {"parent_frame_id", of_type("string")},
                                                                    {"child_frame_id", of_type("string")},
                                                                    {"translation", vector_schema()},
                                                                    {"rotation", rotation_schema()}});
  return object("foxglove.FrameTransforms", {{"transforms", list_of(transform)}});
}

ordered_json scene_update_schema() {
  const ordered_json cube =
      object("foxglove.CubePrimitive",
             {{"pose", pose_schema()}, {"size", vector_schema()}, {"color", color_schema()}});
  const ordered_json arrow = object("foxglove.ArrowPrimitive", {{"pose", pose_schema()},
                                                                {"shaft_length", of_type("number")},
                                                                {"shaft_diameter", of_type("number")},
                                                                {"head_length", of_type("number")},
                                                                {"head_diameter", of_type("number")},
                                                                {"color", color_schema()}});
  const ordered_json text = object("foxglove.TextPrimitive", {{"pose", pose_schema()},
                                                              {"billboard", of_type("boolean")},
                                                              {"font_size", of_type("number")},
                                                              {"scale_invariant", of_type("boolean")},
                                                              {"color", color_schema()},
                                                              {"text", of_type("string")}});
  const ordered_json entity = object("foxglove.SceneEntity", {{"timestamp", time_schema("time")},
                                                              {"frame_id", of_type("string")},
                                                              {"id", of_type("string")},
                                                              {"lifetime", time_schema("duration")},
                                                              {"frame_locked", of_type("boolean")},
                                                              {"arrows", list_of(arrow)},
                                                              {"cubes", list_of(cube)},
                                                              {"texts", list_of(text)}});
  const ordered_json deletion =
      object("foxglove.SceneEntityDeletion",
             {{"timestamp", time_schema("time")}, {"type", of_type("integer")}, {"id", of_type("string")}});
  return object("foxglove.SceneUpdate", {{"deletions", list_of(deletion)}, {"entities", list_of(entity)}});
}

ordered_json in_frame_schema(const char* title, const char* name, ordered_json content) {
  return object(
      title,
      {{"timestamp", time_schema("time")}, {"frame_id", of_type("string")}, {name, std::move(content)}});
}

// --- messages
// --------------------------------------------------------------------------------------------------

ordered_json time_json(double stamp_s) {
  const std::uint64_t ns = to_ns(stamp_s);
  return {{"sec", ns / kNanosecondsPerSecond}, {"nsec", ns % kNanosecondsPerSecond}};
}

ordered_json vector_json(const Eigen::Vector3d& v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

ordered_json rotation_json(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}

ordered_json pose_json(const SE3& pose) {
  return {{"position", vector_json(pose.translation())}, {"orientation", rotation_json(pose.rotation())}};
}

ordered_json color_json(double r, double g, double b, double a) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}

ordered_json transform_json(std::string_view parent, std::string_view child, const SE3& T_parent_child,
                            double stamp_s) {
  return {{"timestamp", time_json(stamp_s)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", vector_json(T_parent_child.translation())},
          {"rotation", rotation_json(T_parent_child.rotation())}};
}

SE3 above(const SE3& T_map_object, double height_m) {
  return SE3(Eigen::Quaterniond::Identity(),
             T_map_object.translation() + height_m * Eigen::Vector3d::UnitZ());
}

ordered_json arrow_json(const SceneObject& object, const ordered_json& color) {
  const Eigen::Vector3d ahead(object.velocity_map_mps.x(), object.velocity_map_mps.y(), 0.0);
  const Eigen::Quaterniond rotation = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), ahead);
  constexpr double kHead_m = 0.5;
  return {{"pose", pose_json(SE3(rotation, object.T_map_object.translation()))},
          {"shaft_length", std::max(0.01, ahead.norm() - kHead_m)},
          {"shaft_diameter", 0.15},
          {"head_length", kHead_m},
          {"head_diameter", 0.4},
          {"color", color}};
}

// Red what moves, green what stands.
ordered_json entity_json(const SceneObject& object, double stamp_s) {
  const bool moving = object.moving;
  const ordered_json color = moving ? color_json(0.9, 0.2, 0.1, 0.5) : color_json(0.1, 0.7, 0.3, 0.5);
  const ordered_json cube{
      {"pose", pose_json(object.T_map_object)}, {"size", vector_json(object.size_lwh_m)}, {"color", color}};
  const std::string name = fmt::format("{} {}, {:.1f} m/s", to_string(object.object_class), object.id,
                                       object.velocity_map_mps.norm());
  const ordered_json text{{"pose", pose_json(above(object.T_map_object, 0.5 * object.size_lwh_m.z() + 0.5))},
                          {"billboard", true},
                          {"font_size", 0.6},
                          {"scale_invariant", false},
                          {"color", color_json(1.0, 1.0, 1.0, 1.0)},
                          {"text", name}};
  ordered_json arrows = ordered_json::array();
  if (moving) arrows.push_back(arrow_json(object, color));
  return {{"timestamp", time_json(stamp_s)},
          {"frame_id", "map"},
          {"id", std::to_string(object.id)},
          {"lifetime", {{"sec", 0}, {"nsec", 0}}},  // until it is deleted
          {"frame_locked", false},
          {"arrows", arrows},
          {"cubes", ordered_json::array({cube})},
          {"texts", ordered_json::array({text})}};
}

}  // namespace

std::uint64_t to_ns(double stamp_s) {
  return static_cast<std::uint64_t>(std::llround(std::max(0.0, stamp_s) * 1e9));
}

std::string schema(std::string_view name) {
  if (name == "PointCloud") return point_cloud_schema().dump();
  if (name == "PoseInFrame") return in_frame_schema("foxglove.PoseInFrame", "pose", pose_schema()).dump();
  if (name == "PosesInFrame")
    return in_frame_schema("foxglove.PosesInFrame", "poses", list_of(pose_schema())).dump();
  if (name == "SceneUpdate") return scene_update_schema().dump();
  return frame_transforms_schema().dump();
}

std::string point_cloud(const SceneCloud& cloud, std::string_view frame, double stamp_s) {
  ArchiveWriter data;
  for_each_point(cloud, [&](const ScenePoint& point, const PointGroup& group) {
    const float intensity = std::clamp(std::round(point.intensity * 255.0F), 0.0F, 255.0F);
    data(point.p, static_cast<std::uint8_t>(intensity), group.label);
  });
  const auto field = [](const char* name, int offset, int type) {
    return ordered_json{{"name", name}, {"offset", offset}, {"type", type}};
  };
  return ordered_json{{"timestamp", time_json(stamp_s)},
                      {"frame_id", frame},
                      {"pose", pose_json(SE3())},
                      {"point_stride", 14},
                      {"fields",
                       {field("x", 0, kFloat32), field("y", 4, kFloat32), field("z", 8, kFloat32),
                        field("intensity", 12, kUint8), field("label", 13, kUint8)}},
                      {"data", base64(data.bytes())}}
      .dump();
}

std::string pose_in_frame(const SE3& pose, std::string_view frame, double stamp_s) {
  return ordered_json{{"timestamp", time_json(stamp_s)}, {"frame_id", frame}, {"pose", pose_json(pose)}}
      .dump();
}

std::string poses_in_frame(std::span<const SE3> poses, std::string_view frame, double stamp_s) {
  ordered_json list = ordered_json::array();
  for (const SE3& pose : poses) list.push_back(pose_json(pose));
  return ordered_json{{"timestamp", time_json(stamp_s)}, {"frame_id", frame}, {"poses", list}}.dump();
}

std::string object_frame(long id) {
  return fmt::format("object_{}", id);
}

std::string frame_transforms(const SceneScan& scan) {
  const SE3 T_map_odom = scan.T_map_lidar * scan.T_odom_lidar.inverse();
  ordered_json transforms = ordered_json::array();
  transforms.push_back(transform_json("map", "odom", T_map_odom, scan.stamp_s));
  transforms.push_back(transform_json("odom", "lidar", scan.T_odom_lidar, scan.stamp_s));
  for (const SceneObject& object : scan.objects) {
    transforms.push_back(transform_json("map", object_frame(object.id), object.T_map_object, scan.stamp_s));
  }
  return ordered_json{{"transforms", transforms}}.dump();
}

std::string scene_update(const SceneScan& scan, std::span<const long> gone) {
  constexpr int kMatchingId = 0;
  ordered_json deletions = ordered_json::array();
  for (const long id : gone) {
    deletions.push_back(
        {{"timestamp", time_json(scan.stamp_s)}, {"type", kMatchingId}, {"id", std::to_string(id)}});
  }
  ordered_json entities = ordered_json::array();
  for (const SceneObject& object : scan.objects) entities.push_back(entity_json(object, scan.stamp_s));
  return ordered_json{{"deletions", deletions}, {"entities", entities}}.dump();
}

}  // namespace mlo::foxglove
