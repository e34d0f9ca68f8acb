#include "mlo/io/detections.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/core/log_odds.hpp"
#include "mlo/io/detection_formats.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

/// What comes from one detector: its scores mean the same in all files.
struct Source {
  fs::path path;
  std::vector<ParsedDetection> detections;
};

std::vector<ParsedDetection> parse_file(const fs::path& path, const Calibration& calibration) {
  const std::string text = read_file(path);
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const std::optional<TextLine> line = line_at(text, begin);
  if (!line) return {};
  if (text[begin] == '{' || text[begin] == '[') return parse_json_detections(path, text);
  const std::string_view first = line->text;
  const bool named_columns =
      first.find(',') != std::string_view::npos && !parse_number(split_cells(first)[0]);
  if (named_columns) return parse_csv_detections(path, text);
  return parse_kitti_detections(path, text, parse_count(path.stem().string()), calibration);
}

bool is_detection_file(const fs::path& path) {
  const std::string extension = to_lower(path.extension().string());
  return fs::is_regular_file(path) && (extension == ".txt" || extension == ".csv" || extension == ".json");
}

/// What lies in a folder, sorted by name.
struct Listing {
  std::vector<fs::path> files;
  std::vector<fs::path> folders;
};

Listing list(const fs::path& folder) {
  Listing listing;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory()) listing.folders.push_back(entry.path());
    if (is_detection_file(entry.path())) listing.files.push_back(entry.path());
  }
  std::sort(listing.files.begin(), listing.files.end());
  std::sort(listing.folders.begin(), listing.folders.end());
  return listing;
}

/// True if the name is the sequence's, or the same number written with other zeros.
bool names_sequence(const fs::path& path, const std::string& sequence) {
  const std::string stem = path.stem().string();
  const auto number = parse_count(stem);
  return !sequence.empty() && (stem == sequence || (number && number == parse_count(sequence)));
}

bool has_file_per_frame(const std::vector<fs::path>& files) {
  const auto begun =
      std::find_if(files.begin(), files.end(), [](const fs::path& f) { return fs::file_size(f) > 0; });
  return begun != files.end() && is_file_per_frame(read_file(*begun));
}

Source read_files(const fs::path& path, const std::vector<fs::path>& files, const Calibration& calibration) {
  Source source{path, {}};
  for (const fs::path& file : files) {
    std::vector<ParsedDetection> detections = parse_file(file, calibration);
    source.detections.insert(source.detections.end(), detections.begin(), detections.end());
  }
  return source;
}

std::string names_of(const std::vector<fs::path>& paths) {
  constexpr std::size_t kMany = 12;
  std::string names;
  for (std::size_t i = 0; i < std::min(paths.size(), kMany); ++i) names += ' ' + paths[i].stem().string();
  return paths.size() > kMany ? names + " ..." : names;
}

/// The detectors' outputs that a path stands for.
std::vector<Source> read_sources(const fs::path& path, const Calibration& calibration,
                                 const std::string& sequence) {
  if (!fs::exists(path)) {
    throw InputError(fmt::format("{}: there are no such detections; check the path", path.string()));
  }
  if (!fs::is_directory(path)) return {read_files(path, {path}, calibration)};
  const Listing inside = list(path);
  if (has_file_per_frame(inside.files)) return {read_files(path, inside.files, calibration)};
  for (const fs::path& file : inside.files) {
    if (names_sequence(file, sequence)) return {read_files(path, {file}, calibration)};
  }
  for (const fs::path& folder : inside.folders) {
    if (names_sequence(folder, sequence)) return read_sources(folder, calibration, sequence);
  }
  if (inside.files.size() == 1 && sequence.empty()) return {read_files(path, inside.files, calibration)};
  if (!inside.files.empty()) {
    throw InputError(fmt::format("{}: no detections for sequence '{}'; choose one of:{}", path.string(),
                                 sequence, names_of(inside.files)));
  }
  if (inside.folders.empty()) {
    throw InputError(
        fmt::format("{}: holds no detections; they are .txt, .csv or .json files", path.string()));
  }
  std::vector<Source> sources;
  for (const fs::path& folder : inside.folders) {
    for (Source& source : read_sources(folder, calibration, sequence)) sources.push_back(std::move(source));
  }
  return sources;
}

bool is_confidence(double score) {
  return score >= 0.0 && score <= 1.0;
}

void set_confidences(Source& source, ScoreKind kind) {
  const bool all_confidences =
      std::all_of(source.detections.begin(), source.detections.end(),
                  [](const ParsedDetection& parsed) { return is_confidence(parsed.record.raw_score); });
  if (kind == ScoreKind::confidence && !all_confidences) {
    throw InputError(
        fmt::format("{}: has scores outside [0, 1], which are no confidences; read them as logits",
                    source.path.string()));
  }
  const bool logits = kind == ScoreKind::logit || (kind == ScoreKind::automatic && !all_confidences);
  for (ParsedDetection& parsed : source.detections) {
    const double score = parsed.record.raw_score;
    parsed.record.detection.confidence = logits ? probability(score) : score;
  }
}

std::set<ObjectClass> classes_of(const Source& source) {
  std::set<ObjectClass> classes;
  for (const ParsedDetection& parsed : source.detections)
    classes.insert(parsed.record.detection.object_class);
  return classes;
}

void check_classes(const std::vector<Source>& sources) {
  std::map<ObjectClass, const Source*> seen;
  for (const Source& source : sources) {
    for (const ObjectClass object_class : classes_of(source)) {
      const auto [first, added] = seen.emplace(object_class, &source);
      if (added) continue;
      throw InputError(
          fmt::format("{} and {}: both have detections of class {}, most likely of two detectors; "
                      "choose one",
                      first->second->path.string(), source.path.string(), to_string(object_class)));
    }
  }
}

}  // namespace

std::span<const DetectionRecord> DetectionList::at(std::size_t frame, double stamp_s) const {
  if (by_stamp_s.empty()) {
    const auto found = by_frame.find(frame);
    return found == by_frame.end() ? std::span<const DetectionRecord>{} : found->second;
  }
  auto nearest = by_stamp_s.lower_bound(stamp_s);
  const auto before = nearest == by_stamp_s.begin() ? nearest : std::prev(nearest);
  if (nearest == by_stamp_s.end() || stamp_s - before->first < nearest->first - stamp_s) nearest = before;
  if (!(std::abs(nearest->first - stamp_s) <= stamp_tolerance_s)) return {};
  return nearest->second;
}

std::vector<Detection> DetectionList::detections_at(std::size_t frame, double stamp_s) const {
  std::vector<Detection> detections;
  for (const DetectionRecord& record : at(frame, stamp_s)) detections.push_back(record.detection);
  return detections;
}

std::size_t DetectionList::count() const {
  std::size_t count = 0;
  for (const auto& [frame, records] : by_frame) count += records.size();
  for (const auto& [stamp_s, records] : by_stamp_s) count += records.size();
  return count;
}

DetectionList read_detections(const std::vector<fs::path>& paths, const Calibration& calibration,
                              const DetectionOptions& options) {
  std::vector<Source> sources;
  for (const fs::path& path : paths) {
    for (Source& source : read_sources(path, calibration, options.sequence))
      sources.push_back(std::move(source));
  }
  check_classes(sources);
  DetectionList list;
  list.stamp_tolerance_s = options.stamp_tolerance_s;
  for (Source& source : sources) {
    set_confidences(source, options.scores);
    for (const ParsedDetection& parsed : source.detections) {
      auto& records = parsed.frame ? list.by_frame[*parsed.frame] : list.by_stamp_s[parsed.stamp_s];
      records.push_back(parsed.record);
    }
    if (!list.by_frame.empty() && !list.by_stamp_s.empty()) {
      throw InputError(fmt::format("{}: has stamps where others have frames, or both; use one of the two",
                                   source.path.string()));
    }
  }
  return list;
}

std::string detection_csv_header() {
  return "frame,class,x_m,y_m,z_m,length_m,width_m,height_m,yaw_rad,score\n";
}

std::string detection_csv_lines(std::size_t frame, std::span<const Detection> detections) {
  std::string lines;
  for (const Detection& detection : detections) {
    const Eigen::Vector3d& p = detection.box.center_lidar_m;
    const Eigen::Vector3d& size = detection.box.size_lwh_m;
    lines += fmt::format("{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.5f},{:.12g}\n", frame,
                         to_string(detection.object_class), p.x(), p.y(), p.z(), size.x(), size.y(), size.z(),
                         detection.box.yaw_rad, detection.confidence);
  }
  return lines;
}

}  // namespace mlo
