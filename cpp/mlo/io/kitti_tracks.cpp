#include "mlo/io/kitti_tracks.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/text_table.hpp"

namespace mlo {
namespace {

constexpr std::size_t kLabelFields = 17;
constexpr std::size_t kResultFields = 18;

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

// Camera axes are x right, y down, z ahead; rotation_y turns about y, 0 along x.
Box3d level_box(const TextRow& row) {
  const double height_m = row.number(10);
  Box3d box;
  box.size_lwh_m = {row.number(12), row.number(11), height_m};
  box.center_lidar_m = {row.number(15), -row.number(13), -(row.number(14) - 0.5 * height_m)};
  box.yaw_rad = -row.number(16) - 0.5 * std::numbers::pi;
  return box;
}

ObjectRecord object_record(const TextRow& row) {
  if (row.size() != kLabelFields && row.size() != kResultFields) {
    row.fail(fmt::format("{} fields; expected 17 (label) or 18 (result with score) of a KITTI tracking file",
                         row.size()));
  }
  const long frame = row.integer(0);
  if (frame < 0) row.fail(fmt::format("frame {} is negative", frame));
  ObjectRecord record;
  record.frame = static_cast<std::size_t>(frame);
  record.track_id = row.integer(1);
  record.type = lower(row.text(2));
  record.truncation = static_cast<int>(row.number(3));
  record.occlusion = static_cast<int>(row.number(4));
  record.image_box = {row.number(6), row.number(7), row.number(8), row.number(9)};
  record.box = level_box(row);
  if (row.size() == kResultFields) record.score = row.number(17);
  return record;
}

}  // namespace

std::vector<ObjectRecord> read_kitti_tracks(const std::filesystem::path& file) {
  const TextTable table(file);
  std::vector<ObjectRecord> records;
  records.reserve(table.rows().size());
  for (const TextRow& row : table.rows()) records.push_back(object_record(row));
  return records;
}

std::map<std::string, std::vector<ObjectRecord>> read_kitti_sequences(const std::filesystem::path& path) {
  std::map<std::string, std::vector<ObjectRecord>> sequences;
  if (!std::filesystem::is_directory(path)) {
    sequences.emplace(path.stem().string(), read_kitti_tracks(path));
    return sequences;
  }
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.path().extension() != ".txt") continue;
    sequences.emplace(entry.path().stem().string(), read_kitti_tracks(entry.path()));
  }
  if (sequences.empty()) {
    throw InputError(
        fmt::format("{}: holds no .txt files; expected one KITTI tracking file per sequence", path.string()));
  }
  return sequences;
}

}  // namespace mlo
