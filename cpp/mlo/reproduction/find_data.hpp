#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace mlo {

/// Sequences of KITTI below a folder, by the names that the paper gives them.
struct KittiData {
  std::map<std::string, std::filesystem::path> odometry;  ///< "04" to its folder
  std::map<std::string, std::filesystem::path> raw;       ///< "0926-0005" to the drive's folder
  std::map<std::string, std::filesystem::path> tracking;  ///< "0001" to its scans
  /// Label and calibration folders of the tracking benchmark's training part, and cars that PointRCNN found.
  std::optional<std::filesystem::path> labels, calibration, car_detections;
};

/// Looks in the folder and up to two levels below it for the layouts of the three benchmarks.
KittiData find_kitti(const std::filesystem::path& root);

/// "2011_09_26_drive_0005_sync" is "0926-0005"; nothing for other names.
std::optional<std::string> paper_name_of_drive(const std::string& folder_name);

/// The sequence of the tracking benchmark's training part that a drive became: "0926-0005" is "0000"; nothing
/// for drives that are not in it.
std::optional<std::string> tracking_sequence_of(const std::string& drive);

}  // namespace mlo
