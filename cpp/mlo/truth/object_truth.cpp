#include "mlo/truth/object_truth.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/kitti_box.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

// Walks over the elements of a tracklet file. Its layout is fixed (a boost archive), so that finding the next
// element of a name is all that is needed of XML.
class ElementCursor {
 public:
  ElementCursor(std::string_view text, const std::filesystem::path& file) : text_(text), file_(file) {}

  /// The content of the next element of this name before the limit; nothing if there is none.
  std::optional<std::string_view> next(std::string_view name, std::size_t limit) {
    const std::string opening = fmt::format("<{}>", name);
    const std::size_t begin = text_.find(opening, offset_);
    if (begin == std::string_view::npos || begin >= limit) return std::nullopt;
    const std::size_t content = begin + opening.size();
    const std::size_t end = text_.find(fmt::format("</{}>", name), content);
    if (end == std::string_view::npos) fail(fmt::format("<{}> is not closed; the file may be cut off", name));
    offset_ = end;
    return text_.substr(content, end - content);
  }
  double number(std::string_view name, std::size_t limit) {
    const auto content = next(name, limit);
    if (!content) fail(fmt::format("a tracklet has no <{}>", name));
    const std::optional<double> value = parse_number(*content);
    if (!value) fail(fmt::format("<{}>: '{}' is no number", name, *content));
    return *value;
  }
  /// Where the next element of this name begins; the end of the text if there is none.
  std::size_t find(std::string_view name) const {
    return std::min(text_.find(fmt::format("<{}>", name), offset_), text_.size());
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(fmt::format("{}: {}", file_.string(), problem));
  }

  std::string_view text_;
  const std::filesystem::path& file_;
  std::size_t offset_ = 0;
};

}  // namespace

std::vector<ObjectBox> boxes_in_lidar(std::span<const ObjectRecord> records, const SE3& T_camera0_lidar) {
  std::vector<ObjectBox> boxes;
  for (const ObjectRecord& record : records) {
    if (record.track_id < 0) continue;
    boxes.push_back(
        {record.frame, record.track_id, record.type, box_in_lidar(kitti_box_of(record), T_camera0_lidar)});
  }
  return boxes;
}

std::vector<ObjectBox> read_tracklets(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  if (text.find("<tracklets") == std::string::npos) {
    throw InputError(
        fmt::format("{}: holds no <tracklets>; give a tracklet_labels.xml of KITTI raw", file.string()));
  }
  ElementCursor cursor(text, file);
  std::vector<ObjectBox> boxes;
  for (long id = 0; const auto type = cursor.next("objectType", text.size()); ++id) {
    const std::size_t end = cursor.find("objectType");
    Box3d box;
    box.size_lwh_m.z() = cursor.number("h", end);
    box.size_lwh_m.y() = cursor.number("w", end);
    box.size_lwh_m.x() = cursor.number("l", end);
    auto frame = static_cast<std::size_t>(std::max(0.0, cursor.number("first_frame", end)));
    for (; cursor.find("tx") < end; ++frame) {
      box.center_lidar_m.x() = cursor.number("tx", end);
      box.center_lidar_m.y() = cursor.number("ty", end);
      box.center_lidar_m.z() = cursor.number("tz", end) + 0.5 * box.size_lwh_m.z();  // tz is its bottom
      box.yaw_rad = cursor.number("rz", end);
      boxes.push_back({frame, id, to_lower(*type), box});
    }
  }
  return boxes;
}

std::vector<ObjectBox> annotated_boxes(const Dataset& dataset) {
  if (!dataset.labels.empty() && dataset.calibration.T_camera0_lidar) {
    return boxes_in_lidar(read_kitti_tracks(dataset.labels), *dataset.calibration.T_camera0_lidar);
  }
  const std::filesystem::path tracklets = dataset.root / "tracklet_labels.xml";
  if (std::filesystem::exists(tracklets)) return read_tracklets(tracklets);
  return {};
}

std::vector<ObjectPose> objects_in_map(std::span<const ObjectBox> boxes, const PoseList& poses) {
  std::map<std::size_t, std::size_t> index_of_frame;
  for (std::size_t i = 0; i < poses.frames.size(); ++i) index_of_frame.emplace(poses.frames[i], i);
  std::vector<ObjectPose> objects;
  for (const ObjectBox& box : boxes) {
    const auto found = index_of_frame.find(box.frame);
    if (found == index_of_frame.end()) continue;
    const std::size_t index = found->second;
    ObjectPose object;
    object.frame = box.frame;
    if (index < poses.stamps_s.size()) object.stamp_s = poses.stamps_s[index];
    object.id = box.id;
    object.type = box.type;
    object.T_map_object = poses.T_world_body[index] * box.box_lidar.T_lidar_object();
    object.size_lwh_m = box.box_lidar.size_lwh_m;
    objects.push_back(std::move(object));
  }
  std::stable_sort(objects.begin(), objects.end(), [](const ObjectPose& a, const ObjectPose& b) {
    return std::tie(a.frame, a.id) < std::tie(b.frame, b.id);
  });
  return objects;
}

}  // namespace mlo
