#include "mlo/io/dataset.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mlo/core/error.hpp"
#include "mlo/io/kitti_odometry.hpp"
#include "mlo/io/kitti_raw.hpp"
#include "mlo/io/kitti_tracking.hpp"
#include "mlo/io/plain_folder.hpp"
#include "mlo/io/sequence_files.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

struct Layout {
  std::string_view name;
  std::string_view looks_like;
  std::vector<SequenceFolder> (*find)(const fs::path&);
  Dataset (*open)(const SequenceFolder&, const OpenOptions&);
};

// In the order in which they are tried.
constexpr std::array kLayouts{
    Layout{"kitti_odometry", "sequences/NN/velodyne/*.bin", find_kitti_odometry, open_kitti_odometry},
    Layout{"kitti_raw", "DATE/DATE_drive_NNNN_sync/velodyne_points/data/*.bin", find_kitti_raw,
           open_kitti_raw},
    Layout{"kitti_tracking", "training/velodyne/NNNN/*.bin", find_kitti_tracking, open_kitti_tracking},
    Layout{"folder", "*.bin, *.pcd or *.ply", find_plain_folder, open_plain_folder},
};

// Absolute, and without a slash at the end, so that it has a name.
fs::path tidy(const fs::path& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

std::vector<Layout> layouts_to_try(const std::string& format) {
  std::vector<std::string_view> names{"auto"};
  for (const Layout& layout : kLayouts) names.push_back(layout.name);
  if (std::find(names.begin(), names.end(), format) == names.end()) {
    throw InputError(
        fmt::format("format '{}' is not known; choose one of {}", format, fmt::join(names, ", ")));
  }
  std::vector<Layout> layouts(kLayouts.begin(), kLayouts.end());
  if (format != "auto") std::erase_if(layouts, [&](const Layout& layout) { return layout.name != format; });
  return layouts;
}

std::string names_of(const std::vector<SequenceFolder>& sequences) {
  std::vector<std::string> names;
  for (const SequenceFolder& sequence : sequences) names.push_back(sequence.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

const SequenceFolder& select(const std::vector<SequenceFolder>& sequences, const std::string& wanted,
                             const fs::path& folder) {
  std::vector<const SequenceFolder*> matches;
  const std::optional<std::size_t> number = parse_count(wanted);
  for (const SequenceFolder& sequence : sequences) {
    if (wanted == sequence.name) return sequence;
    if (wanted.empty() || (number && number == sequence.number)) matches.push_back(&sequence);
  }
  if (matches.size() == 1) return *matches.front();
  if (wanted.empty() || !matches.empty()) {
    throw InputError(fmt::format("{}: holds several sequences{}; name one (--sequence): {}", folder.string(),
                                 wanted.empty() ? "" : fmt::format(" with number {}", wanted),
                                 names_of(sequences)));
  }
  if (sequences.front().name.empty()) {
    throw InputError(fmt::format("{}: a plain folder of scans has no sequence '{}'; leave out --sequence",
                                 folder.string(), wanted));
  }
  throw InputError(
      fmt::format("{}: no sequence '{}'; there is {}", folder.string(), wanted, names_of(sequences)));
}

}  // namespace

Dataset open_dataset(const fs::path& folder, const OpenOptions& options) {
  if (!fs::is_directory(folder)) {
    throw InputError(
        fmt::format("{}: is not a folder; give the folder that holds the scans", folder.string()));
  }
  const fs::path root = tidy(folder);
  const std::vector<Layout> layouts = layouts_to_try(options.format);
  for (const Layout& layout : layouts) {
    const std::vector<SequenceFolder> sequences = layout.find(root);
    if (!sequences.empty()) return layout.open(select(sequences, options.sequence, folder), options);
  }
  std::vector<std::string> looked_for;
  for (const Layout& layout : layouts) {
    looked_for.push_back(fmt::format("{} ({})", layout.name, layout.looks_like));
  }
  throw InputError(
      fmt::format("{}: no scans found; looked for {}; give the folder above or below, or --format",
                  folder.string(), fmt::join(looked_for, ", ")));
}

}  // namespace mlo
