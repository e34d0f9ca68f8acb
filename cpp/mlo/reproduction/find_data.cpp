#include "mlo/reproduction/find_data.hpp"

#include <vector>

#include "mlo/io/kitti_odometry.hpp"
#include "mlo/io/kitti_raw.hpp"
#include "mlo/io/kitti_tracking.hpp"
#include "mlo/io/sequence_files.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> candidates_below(const fs::path& root) {
  std::vector<fs::path> folders{root};
  for (const fs::path& child : subfolders(root)) {
    folders.push_back(child);
    for (const fs::path& grandchild : subfolders(child)) folders.push_back(grandchild);
  }
  return folders;
}

// The training part of the tracking benchmark that has labels.
void find_training(const fs::path& folder, KittiData& data) {
  if (data.labels || !is_directory(folder / "label_02") || !is_directory(folder / "calib")) return;
  data.labels = folder / "label_02";
  data.calibration = folder / "calib";
  if (const fs::path cars = folder / "detections" / "pointrcnn_car"; is_directory(cars)) {
    data.car_detections = cars;
  }
}

}  // namespace

std::optional<std::string> paper_name_of_drive(const std::string& folder_name) {
  // 2011_09_26_drive_0005_...
  constexpr std::size_t kLength = 21;
  const bool fits = folder_name.size() >= kLength && folder_name.compare(10, 7, "_drive_") == 0 &&
                    folder_name[4] == '_' && folder_name[7] == '_';
  if (!fits) return std::nullopt;
  return folder_name.substr(5, 2) + folder_name.substr(8, 2) + "-" + folder_name.substr(17, 4);
}

std::optional<std::string> tracking_sequence_of(const std::string& drive) {
  static const std::map<std::string, std::string> kSequences{
      {"0926-0005", "0000"}, {"0926-0009", "0001"}, {"0926-0011", "0002"}, {"0926-0013", "0003"},
      {"0926-0014", "0004"}, {"0926-0015", "0005"}, {"0926-0018", "0006"}, {"0926-0022", "0007"},
      {"0926-0032", "0008"}, {"0926-0036", "0009"}, {"0926-0056", "0010"}, {"0926-0059", "0011"}};
  const auto found = kSequences.find(drive);
  return found == kSequences.end() ? std::nullopt : std::optional(found->second);
}

KittiData find_kitti(const fs::path& root) {
  KittiData data;
  for (const fs::path& folder : candidates_below(root)) {
    for (const SequenceFolder& found : find_kitti_raw(folder)) {
      if (const auto name = paper_name_of_drive(found.name)) data.raw.emplace(*name, found.path);
    }
    for (const SequenceFolder& found : find_kitti_tracking(folder))
      data.tracking.emplace(found.name, found.path);
    for (const SequenceFolder& found : find_kitti_odometry(folder))
      data.odometry.emplace(found.name, found.path);
    find_training(folder, data);
  }
  return data;
}

}  // namespace mlo
