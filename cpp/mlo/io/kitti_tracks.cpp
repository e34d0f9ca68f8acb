#include "mlo/io/kitti_tracks.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/kitti_box.hpp"
#include "mlo/io/text.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

// Numbers of a row, without the type that stands between the second and the third.
constexpr std::size_t kLabelNumbers = 16;
constexpr std::size_t kResultNumbers = 17;
constexpr std::size_t kObjectWords = 15;

// "car" to "Car", "dontcare" to "DontCare".
std::string kitti_spelling(std::string type) {
  if (type == "dontcare") return "DontCare";
  if (!type.empty()) type.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(type.front())));
  return type;
}

std::string kitti_row(const ObjectRecord& record) {
  const KittiBox box = kitti_box_of(record);
  const Eigen::Vector3d& p = box.bottom_camera0_m;
  const Box2d& image = record.image_box;
  return fmt::format(
      "{} {} {} {} {} {:.6f} {:.4f} {:.4f} {:.4f} {:.4f} {:.5f} {:.5f} {:.5f} {:.5f} {:.5f} {:.5f} {:.6f} "
      "{:.6f}\n",
      record.frame, record.track_id, kitti_spelling(record.type), record.truncation, record.occlusion,
      observation_angle_rad(box), image.left_px, image.top_px, image.right_px, image.bottom_px, box.height_m,
      box.width_m, box.length_m, p.x(), p.y(), p.z(), box.rotation_y_rad, record.score);
}

ObjectRecord object_record(const std::string& line, const std::string& where) {
  std::istringstream stream(line);
  std::string frame;
  std::string id;
  std::string type;
  std::string rest;
  std::getline(stream >> frame >> id >> type, rest);
  const std::vector<double> v = parse_numbers(frame + " " + id + " " + rest, where);
  const bool finite = std::all_of(v.begin(), v.end(), [](double value) { return std::isfinite(value); });
  if ((v.size() != kLabelNumbers && v.size() != kResultNumbers) || !finite) {
    throw InputError(
        fmt::format("{}: not frame, id, type and 14 (label) or 15 (result with score) finite numbers, as "
                    "KITTI tracking files have them",
                    where));
  }
  if (v[0] < 0.0 || v[0] != std::floor(v[0]) || v[1] != std::floor(v[1])) {
    throw InputError(fmt::format("{}: frame {} and id {} must be whole numbers, the frame not negative",
                                 where, v[0], v[1]));
  }
  ObjectRecord record;
  record.frame = static_cast<std::size_t>(v[0]);
  record.track_id = static_cast<long>(v[1]);
  record.type = to_lower(type);
  record.truncation = static_cast<int>(v[2]);
  record.occlusion = static_cast<int>(v[3]);
  record.image_box = {v[5], v[6], v[7], v[8]};
  const KittiBox box{.bottom_camera0_m = {v[12], v[13], v[14]},
                     .height_m = v[9],
                     .width_m = v[10],
                     .length_m = v[11],
                     .rotation_y_rad = v[15]};
  record.box = box_in_lidar(box, T_camera0_level());
  if (v.size() == kResultNumbers) record.score = v[16];
  return record;
}

int truncation_step(double share) {
  return share <= 0.15 ? 0 : share <= 0.30 ? 1 : share <= 0.50 ? 2 : 3;
}

}  // namespace

SE3 T_camera0_level() {
  return {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), Eigen::Vector3d::Zero()};
}

std::vector<ObjectRecord> read_kitti_tracks(const std::filesystem::path& file) {
  const std::vector<std::string> lines = read_lines(file);
  std::vector<ObjectRecord> records;
  records.reserve(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    records.push_back(object_record(lines[i], fmt::format("{}:{}", file.string(), i + 1)));
  }
  return records;
}

std::vector<ObjectRecord> read_kitti_object_labels(const std::filesystem::path& file) {
  const std::vector<std::string> lines = read_lines(file);
  std::vector<ObjectRecord> records;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string where = fmt::format("{}:{}", file.string(), i + 1);
    const std::vector<std::string_view> words = split_words(lines[i]);
    if (words.size() != kObjectWords) {
      throw InputError(fmt::format("{}: has {} values, a label of KITTI's object benchmark has {}", where,
                                   words.size(), kObjectWords));
    }
    const long id = words[0] == "DontCare" ? -1 : static_cast<long>(i);
    records.push_back(object_record(fmt::format("0 {} {}", id, lines[i]), where));
    records.back().truncation = truncation_step(parse_number(words[1]).value_or(0.0));
  }
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

KittiBox kitti_box_of(const ObjectRecord& record) {
  return box_in_camera(record.box, T_camera0_level());
}

void write_kitti_tracks(const std::filesystem::path& file, std::span<const ObjectRecord> records) {
  std::string text;
  for (const ObjectRecord& record : records) text += kitti_row(record);
  write_file_atomically(file, text);
}

}  // namespace mlo
