#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/detection_formats.hpp"
#include "mlo/io/kitti_box.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

constexpr std::size_t kNone = 999;  // a column that a format does not have

/// Where things are in a row. The image box takes four columns; h, w, l and x, y, z three each.
struct RowLayout {
  std::string_view name;
  char separator;
  std::size_t columns;
  std::size_t frame;
  std::size_t type;
  std::size_t alpha;
  std::size_t image_box;
  std::size_t size_hwl;
  std::size_t location;
  std::size_t rotation_y;
  std::size_t score;
};

constexpr RowLayout kRowLayouts[] = {
    {"AB3DMOT", ',', 15, 0, 1, 14, 2, 7, 10, 13, 6},
    {"KITTI tracking label", ' ', 17, 0, 2, 5, 6, 10, 13, 16, kNone},
    {"KITTI tracking result", ' ', 18, 0, 2, 5, 6, 10, 13, 16, 17},
    {"KITTI object label", ' ', 15, kNone, 0, 3, 4, 8, 11, 14, kNone},
    {"KITTI object result", ' ', 16, kNone, 0, 3, 4, 8, 11, 14, 15},
    {"Point-GNN", ' ', 17, 0, 1, 4, 5, 9, 12, 15, 16},
};

using Cells = std::vector<std::string_view>;

Cells split(std::string_view line, char separator) {
  return separator == ',' ? split_cells(line) : split_words(line);
}

/// The format whose columns fit; the class is a word in all but AB3DMOT's, where it is a number.
const RowLayout* recognise(std::string_view line) {
  for (const RowLayout& layout : kRowLayouts) {
    const Cells cells = split(line, layout.separator);
    if (cells.size() != layout.columns) continue;
    const bool word = !parse_number(cells[layout.type]).has_value();
    if (word != (layout.separator == ',')) return &layout;
  }
  return nullptr;
}

ObjectClass class_of(std::string_view cell, const RowLayout& layout, const Place& place) {
  if (layout.separator != ',') return parse_class(cell, place);
  if (cell == "1") return ObjectClass::pedestrian;
  if (cell == "2") return ObjectClass::car;
  if (cell == "3") return ObjectClass::cyclist;
  place.fail(fmt::format("type {} is not known", cell), "use 1 pedestrian, 2 car or 3 cyclist");
}

ParsedDetection parse_row(const Cells& cells, const RowLayout& layout, std::optional<std::size_t> file_frame,
                          const SE3& T_camera0_lidar, const Place& place) {
  const auto number = [&](std::size_t column, std::string_view what) {
    return parse_finite(cells[column], what, place);
  };
  ParsedDetection parsed;
  parsed.frame = layout.frame == kNone ? file_frame : parse_count(cells[layout.frame]);
  if (!parsed.frame) place.fail(fmt::format("'{}' is no frame", cells[layout.frame]), "number frames from 0");
  KittiBox box;
  box.height_m = number(layout.size_hwl, "height");
  box.width_m = number(layout.size_hwl + 1, "width");
  box.length_m = number(layout.size_hwl + 2, "length");
  for (Eigen::Index i = 0; i < 3; ++i) {
    box.bottom_camera0_m(i) = number(layout.location + static_cast<std::size_t>(i), "location");
  }
  box.rotation_y_rad = number(layout.rotation_y, "rotation_y");
  DetectionRecord& record = parsed.record;
  record.detection.object_class = class_of(cells[layout.type], layout, place);
  record.detection.box = box_in_lidar(box, T_camera0_lidar);
  check_box(record.detection.box, place);
  const std::size_t image = layout.image_box;
  record.image_box_px = Box2d{number(image, "image box"), number(image + 1, "image box"),
                              number(image + 2, "image box"), number(image + 3, "image box")};
  record.alpha_rad = number(layout.alpha, "alpha");
  if (layout.score != kNone) record.raw_score = number(layout.score, "score");
  return parsed;
}

}  // namespace

bool is_file_per_frame(std::string_view text) {
  std::size_t offset = 0;
  while (const std::optional<TextLine> line = line_at(text, offset)) {
    offset = line->next_offset;
    if (is_blank(line->text)) continue;
    const RowLayout* const layout = recognise(line->text);
    return layout != nullptr && layout->frame == kNone;
  }
  return false;
}

std::vector<ParsedDetection> parse_kitti_detections(const std::filesystem::path& path, std::string_view text,
                                                    std::optional<std::size_t> file_frame,
                                                    const Calibration& calibration) {
  std::vector<ParsedDetection> detections;
  const RowLayout* layout = nullptr;
  Place place{path, 0};
  for (const std::string_view line : split_lines(text)) {
    ++place.line;
    if (is_blank(line)) continue;
    if (layout == nullptr) layout = recognise(line);
    if (layout == nullptr) {
      place.fail("the format of these detections is not known", "see docs/detections.md for those that are");
    }
    if (!calibration.T_camera0_lidar) {
      place.fail("these boxes are in the camera's frame, and the data has no calibration",
                 "put KITTI's calibration beside the scans, or write the boxes in the lidar's frame");
    }
    const Cells cells = split(line, layout->separator);
    if (cells.size() != layout->columns) {
      place.fail(fmt::format("has {} values, a {} row has {}", cells.size(), layout->name, layout->columns),
                 "write the line again");
    }
    if (cells[layout->type] == "DontCare") continue;
    if (layout->frame == kNone && !file_frame) {
      place.fail("rows of this format have no frame", "name the file by its frame, like 000012.txt");
    }
    detections.push_back(parse_row(cells, *layout, file_frame, *calibration.T_camera0_lidar, place));
  }
  return detections;
}

}  // namespace mlo
