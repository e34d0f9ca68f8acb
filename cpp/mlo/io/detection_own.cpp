#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mlo/core/error.hpp"
#include "mlo/io/detection_formats.hpp"
#include "mlo/io/text.hpp"

// docs/detections.md describes these two formats.
namespace mlo {
namespace {

/// Numbers that both formats have in every row, in this order: centre, size, yaw.
constexpr std::array<std::string_view, 7> kBoxColumns{"x_m",     "y_m",      "z_m",    "length_m",
                                                      "width_m", "height_m", "yaw_rad"};

Box3d make_box(const std::array<double, 7>& v) {
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6]};
}

/// Where the columns of a CSV file are.
struct CsvColumns {
  std::optional<std::size_t> frame;
  std::optional<std::size_t> stamp_s;
  std::optional<std::size_t> score;
  std::size_t object_class = 0;
  std::array<std::size_t, kBoxColumns.size()> box{};
  std::size_t count = 0;
};

CsvColumns find_columns(std::string_view header, const Place& place) {
  const std::vector<std::string_view> names = split_cells(header);
  const auto find = [&names](std::string_view name) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (to_lower(names[i]) == name) return i;
    }
    return std::nullopt;
  };
  const auto require = [&](std::string_view name) {
    const auto column = find(name);
    if (!column)
      place.fail(fmt::format("there is no column {}", name), "see docs/detections.md for the columns");
    return *column;
  };
  CsvColumns columns{find("frame"), find("stamp_s"), find("score"), require("class"), {}, names.size()};
  for (std::size_t i = 0; i < kBoxColumns.size(); ++i) columns.box[i] = require(kBoxColumns[i]);
  if (columns.frame.has_value() == columns.stamp_s.has_value()) {
    place.fail("needs either a column frame or a column stamp_s", "add the one, or take away the other");
  }
  return columns;
}

ParsedDetection parse_csv_row(const std::vector<std::string_view>& cells, const CsvColumns& columns,
                              const Place& place) {
  ParsedDetection parsed;
  if (columns.frame) {
    parsed.frame = parse_count(cells[*columns.frame]);
    if (!parsed.frame)
      place.fail(fmt::format("'{}' is no frame", cells[*columns.frame]), "number frames from 0");
  } else if (columns.stamp_s) {
    parsed.stamp_s = parse_finite(cells[*columns.stamp_s], "stamp_s", place);
  }
  std::array<double, kBoxColumns.size()> box{};
  for (std::size_t i = 0; i < box.size(); ++i) {
    box[i] = parse_finite(cells[columns.box[i]], kBoxColumns[i], place);
  }
  parsed.record.detection.object_class = parse_class(cells[columns.object_class], place);
  parsed.record.detection.box = make_box(box);
  check_box(parsed.record.detection.box, place);
  if (columns.score) parsed.record.raw_score = parse_finite(cells[*columns.score], "score", place);
  return parsed;
}

/// Values of one JSON object, with messages that say which.
class JsonFields {
 public:
  JsonFields(const nlohmann::json& object, const Place& place, std::size_t index)
      : object_(object), place_(place), index_(index) {}

  [[noreturn]] void fail(std::string_view problem) const {
    place_.fail(fmt::format("detections[{}]: {}", index_, problem), "see docs/detections.md");
  }
  bool has(const char* key) const { return object_.is_object() && object_.contains(key); }
  double number(const char* key) const { return finite(at(key), key); }
  Eigen::Vector3d vector(const char* key) const {
    const nlohmann::json& value = at(key);
    if (!value.is_array() || value.size() != 3) fail(fmt::format("{} needs three numbers", key));
    return {finite(value[0], key), finite(value[1], key), finite(value[2], key)};
  }
  std::string text(const char* key) const {
    if (!at(key).is_string()) fail(fmt::format("{} needs a text", key));
    return at(key).get<std::string>();
  }
  std::size_t count(const char* key) const {
    if (!at(key).is_number_unsigned()) fail(fmt::format("{} needs a whole number from 0", key));
    return at(key).get<std::size_t>();
  }

 private:
  const nlohmann::json& at(const char* key) const {
    if (!has(key)) fail(fmt::format("there is no {}", key));
    return object_.at(key);
  }
  double finite(const nlohmann::json& value, const char* key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) fail(fmt::format("{} needs numbers", key));
    return value.get<double>();
  }

  const nlohmann::json& object_;
  const Place& place_;
  std::size_t index_;
};

ParsedDetection parse_json_detection(const JsonFields& fields, const Place& place) {
  ParsedDetection parsed;
  if (fields.has("frame") == fields.has("stamp_s")) fields.fail("needs either frame or stamp_s");
  if (fields.has("frame")) {
    parsed.frame = fields.count("frame");
  } else {
    parsed.stamp_s = fields.number("stamp_s");
  }
  Detection& detection = parsed.record.detection;
  detection.object_class = parse_class(fields.text("class"), place);
  detection.box = {fields.vector("center_m"), fields.vector("size_lwh_m"), fields.number("yaw_rad")};
  check_box(detection.box, place);
  if (fields.has("score")) parsed.record.raw_score = fields.number("score");
  return parsed;
}

}  // namespace

std::vector<ParsedDetection> parse_csv_detections(const std::filesystem::path& path, std::string_view text) {
  std::vector<ParsedDetection> detections;
  std::optional<CsvColumns> columns;
  Place place{path, 0};
  for (const std::string_view line : split_lines(text)) {
    ++place.line;
    if (is_blank(line)) continue;
    if (!columns) {
      columns = find_columns(line, place);
      continue;
    }
    const std::vector<std::string_view> cells = split_cells(line);
    if (cells.size() != columns->count) {
      place.fail(fmt::format("has {} values for {} columns", cells.size(), columns->count),
                 "write the line again");
    }
    detections.push_back(parse_csv_row(cells, *columns, place));
  }
  return detections;
}

std::vector<ParsedDetection> parse_json_detections(const std::filesystem::path& path, std::string_view text) {
  const Place place{path, 0};
  nlohmann::json document;
  try {
    document = nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& error) {
    place.fail(error.what(), "write the file again");
  }
  if (!document.is_object() || !document.contains("detections") || !document["detections"].is_array()) {
    place.fail("there is no list 'detections'", "see docs/detections.md");
  }
  std::vector<ParsedDetection> detections;
  for (const nlohmann::json& object : document["detections"]) {
    detections.push_back(parse_json_detection(JsonFields(object, place, detections.size()), place));
  }
  return detections;
}

}  // namespace mlo
