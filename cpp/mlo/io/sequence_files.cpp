#include "mlo/io/sequence_files.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mlo/core/error.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

// Fills stamps that are not finite from their neighbours, a period per frame; returns how many existing scans
// had none.
std::size_t fill_stamps(std::vector<ScanFile>& scans, double period_s) {
  const auto known = [](const ScanFile& scan) { return std::isfinite(scan.stamp_s); };
  const auto place = [&](ScanFile& scan, const ScanFile& from) {
    scan.stamp_s =
        from.stamp_s + period_s * (static_cast<double>(scan.frame) - static_cast<double>(from.frame));
  };
  std::size_t filled = 0;
  for (const ScanFile& scan : scans) filled += !known(scan) && fs::exists(scan.path);
  const auto first = std::find_if(scans.begin(), scans.end(), known);
  if (first == scans.end()) {
    for (ScanFile& scan : scans) scan.stamp_s = period_s * static_cast<double>(scan.frame);
    return filled;
  }
  for (auto scan = scans.begin(); scan != first; ++scan) place(*scan, *first);
  for (auto scan = first + 1; scan != scans.end(); ++scan) {
    if (!known(*scan)) place(*scan, *(scan - 1));
  }
  return filled;
}

// "177-180, 192" for growing numbers.
std::string ranges_text(const std::vector<std::size_t>& numbers) {
  std::vector<std::string> ranges;
  for (std::size_t begin = 0; begin < numbers.size();) {
    std::size_t end = begin + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    ranges.push_back(end - begin == 1 ? fmt::format("{}", numbers[begin])
                                      : fmt::format("{}-{}", numbers[begin], numbers[end - 1]));
    begin = end;
  }
  return fmt::format("{}", fmt::join(ranges, ", "));
}

}  // namespace

std::vector<fs::path> subfolders(const fs::path& folder) {
  std::vector<fs::path> folders = entries(folder);
  std::erase_if(folders, [](const fs::path& path) { return !fs::is_directory(path); });
  return folders;
}

bool holds_files(const fs::path& folder, const std::string& extension) {
  std::error_code error;
  const fs::directory_iterator files(folder, error);
  return std::any_of(fs::begin(files), fs::end(files),
                     [&](const fs::directory_entry& entry) { return entry.path().extension() == extension; });
}

std::vector<ScanFile> list_numbered_scans(const fs::path& folder, const std::string& extension) {
  constexpr std::size_t kMostFramesPerFile = 1000;
  std::map<std::size_t, fs::path> by_frame;
  for (const fs::path& path : entries(folder)) {
    const std::optional<std::size_t> frame = parse_count(path.stem().string());
    if (frame && path.extension() == extension) by_frame.emplace(*frame, path);
  }
  if (by_frame.empty()) return {};
  const std::size_t first = by_frame.begin()->first;
  const std::size_t last = by_frame.rbegin()->first;
  if (last - first > kMostFramesPerFile * by_frame.size()) {
    throw InputError(fmt::format("{}: {} files with numbers from {} to {}; remove those that are no scans",
                                 folder.string(), by_frame.size(), first, last));
  }
  const std::size_t digits = by_frame.begin()->second.stem().string().size();
  std::vector<ScanFile> scans;
  for (std::size_t frame = first; frame <= last; ++frame) {
    const auto found = by_frame.find(frame);
    const fs::path expected = folder / fmt::format("{:0{}}{}", frame, digits, extension);
    scans.push_back({.path = found == by_frame.end() ? expected : found->second, .frame = frame});
  }
  return scans;
}

std::vector<double> stamps_by_frame(const std::vector<ScanFile>& scans, const std::vector<double>& list_s) {
  std::vector<double> stamps_s;
  for (const ScanFile& scan : scans) {
    stamps_s.push_back(scan.frame < list_s.size() ? list_s[scan.frame] : kNoStamp);
  }
  return stamps_s;
}

std::vector<std::string> set_stamps(std::vector<ScanFile>& scans, const std::vector<double>& stamps_s,
                                    double period_s, const std::string& origin) {
  for (std::size_t i = 0; i < scans.size(); ++i) scans[i].stamp_s = stamps_s[i];
  std::vector<std::string> warnings;
  if (const std::size_t filled = fill_stamps(scans, period_s); filled > 0) {
    warnings.push_back(fmt::format("{}: no time for {} of {} scans; they were placed {:.4f} s apart", origin,
                                   filled, scans.size(), period_s));
  }
  std::size_t unsorted = 0;
  for (std::size_t i = 1; i < scans.size(); ++i) unsorted += scans[i].stamp_s <= scans[i - 1].stamp_s;
  if (unsorted > 0)
    warnings.push_back(fmt::format("{}: times that are not later than the one before: {}", origin, unsorted));
  return warnings;
}

double median_period_s(const std::vector<double>& stamps_s, double fallback_s) {
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < stamps_s.size(); ++i) {
    const double period_s = stamps_s[i] - stamps_s[i - 1];
    if (std::isfinite(period_s) && period_s > 0.0) periods_s.push_back(period_s);
  }
  if (periods_s.empty()) return fallback_s;
  const auto middle = periods_s.begin() + static_cast<std::ptrdiff_t>(periods_s.size() / 2);
  std::nth_element(periods_s.begin(), middle, periods_s.end());
  return *middle;
}

void set_scans(Dataset& dataset, std::vector<ScanFile> scans, ScanFileTraits traits) {
  std::vector<std::size_t> missing;
  for (const ScanFile& scan : scans) {
    dataset.stamps_s.push_back(scan.stamp_s);
    if (!fs::exists(scan.path)) missing.push_back(scan.frame);
  }
  if (!missing.empty()) {
    dataset.warnings.push_back(fmt::format("{}: missing scans ({}): frame {}",
                                           scans.front().path.parent_path().string(), missing.size(),
                                           ranges_text(missing)));
  }
  dataset.scans = std::make_unique<ScanFiles>(std::move(scans), std::move(traits));
}

}  // namespace mlo
