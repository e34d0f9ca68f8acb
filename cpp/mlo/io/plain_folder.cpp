#include "mlo/io/plain_folder.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "mlo/io/text.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

bool is_scan(const fs::path& file) {
  const std::string extension = to_lower(file.extension().string());
  return extension == ".bin" || extension == ".pcd" || extension == ".ply";
}

// Takes a run of digits, or one other character, from the front.
std::string_view take_chunk(std::string_view& text) {
  std::size_t size = 0;
  while (size < text.size() && std::isdigit(static_cast<unsigned char>(text[size])) != 0) ++size;
  const std::string_view chunk = text.substr(0, std::max<std::size_t>(1, size));
  text.remove_prefix(chunk.size());
  return chunk;
}

// "scan9" before "scan10". Runs of digits are compared as numbers: without leading zeros, the longer is the
// larger.
bool natural_less(std::string_view a, std::string_view b) {
  const auto significant = [](std::string_view digits) {
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    return digits;
  };
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    const std::string_view chunk_a = take_chunk(a);
    const std::string_view chunk_b = take_chunk(b);
    const bool numbers = std::isdigit(static_cast<unsigned char>(chunk_a.front())) != 0 &&
                         std::isdigit(static_cast<unsigned char>(chunk_b.front())) != 0;
    const std::string_view key_a = numbers ? significant(chunk_a) : chunk_a;
    const std::string_view key_b = numbers ? significant(chunk_b) : chunk_b;
    if (key_a.size() != key_b.size()) return key_a.size() < key_b.size();
    if (key_a != key_b) return key_a < key_b;
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;
}

std::vector<fs::path> scans_in_order(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_scan(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

// A frame for each file: its place, unless all are numbered with few gaps (names may also be times or
// hashes).
std::vector<ScanFile> list_scans(const fs::path& folder) {
  constexpr double kMostlyThere = 0.5;
  const std::vector<fs::path> files = scans_in_order(folder);
  const std::string extension = files.front().extension().string();
  const bool uniform = std::all_of(files.begin(), files.end(), [&](const fs::path& file) {
    return file.extension() == extension && parse_count(file.stem().string());
  });
  const std::optional<std::size_t> first = parse_count(files.front().stem().string());
  const std::optional<std::size_t> last = parse_count(files.back().stem().string());
  if (uniform && first && last &&
      static_cast<double>(files.size()) >= kMostlyThere * static_cast<double>(*last - *first + 1)) {
    return list_numbered_scans(folder, extension);
  }
  std::vector<ScanFile> scans;
  for (const fs::path& file : files) scans.push_back({.path = file, .frame = scans.size()});
  return scans;
}

// Lines belong to the files one by one if there are as many, otherwise to frames, the first to frame 0.
std::vector<double> stamps_of_scans(const std::vector<ScanFile>& scans, const std::vector<double>& lines_s) {
  const auto present =
      std::count_if(scans.begin(), scans.end(), [](const ScanFile& scan) { return fs::exists(scan.path); });
  if (static_cast<std::size_t>(present) != lines_s.size()) return stamps_by_frame(scans, lines_s);
  std::vector<double> stamps_s;
  std::size_t line = 0;
  for (const ScanFile& scan : scans) stamps_s.push_back(fs::exists(scan.path) ? lines_s[line++] : kNoStamp);
  return stamps_s;
}

std::vector<std::string> read_stamps(const fs::path& folder, double nominal_period_s,
                                     std::vector<ScanFile>& scans) {
  for (const char* name : {"timestamps.txt", "times.txt"}) {
    const fs::path file = folder / name;
    if (!fs::exists(file)) continue;
    const std::vector<double> lines_s = read_stamps_s(file);
    const double period_s = median_period_s(lines_s, nominal_period_s);
    for (ScanFile& scan : scans) scan.duration_s = period_s;
    return set_stamps(scans, stamps_of_scans(scans, lines_s), period_s, file.string());
  }
  set_stamps(scans, stamps_by_frame(scans, {}), nominal_period_s, folder.string());
  return {fmt::format("{}: no timestamps.txt or times.txt; scans were placed {:.4f} s apart", folder.string(),
                      nominal_period_s)};
}

}  // namespace

std::vector<SequenceFolder> find_plain_folder(const fs::path& folder) {
  const fs::directory_iterator files(folder);
  const bool has_scans = std::any_of(fs::begin(files), fs::end(files),
                                     [](const fs::directory_entry& entry) { return is_scan(entry.path()); });
  if (!has_scans) return {};
  return {{"", std::nullopt, folder}};
}

Dataset open_plain_folder(const SequenceFolder& folder, const OpenOptions& options) {
  Dataset dataset;
  dataset.format = "folder";
  dataset.root = folder.path;
  dataset.sensor = options.sensor.value_or(SensorConfig{});
  std::vector<ScanFile> scans = list_scans(folder.path);
  const double period_s = 1.0 / dataset.sensor.rate_hz;
  for (ScanFile& scan : scans) scan.duration_s = period_s;
  dataset.warnings = read_stamps(folder.path, period_s, scans);
  set_scans(dataset, std::move(scans), {.sensor = dataset.sensor});
  return dataset;
}

}  // namespace mlo
