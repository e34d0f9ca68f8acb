#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mlo/io/scan_files.hpp"

namespace mlo {

/// A sequence of scans that a layout found in a folder.
struct SequenceFolder {
  std::string name;                   ///< as users call it: "04", "2011_09_26_drive_0005_sync"
  std::optional<std::size_t> number;  ///< what --sequence may also name it by
  std::filesystem::path path;
};

/// Folders within a folder, links followed, in the order of their names; empty if it is no folder.
std::vector<std::filesystem::path> subfolders(const std::filesystem::path& folder);

/// True if the folder directly holds a file with the extension (".bin").
bool holds_files(const std::filesystem::path& folder, const std::string& extension);

/// The scans of a folder whose file names are frame numbers, from the first to the last; files missing in
/// between are listed too (they will be reported when read). Other files are passed over. Stamps are not set.
std::vector<ScanFile> list_numbered_scans(const std::filesystem::path& folder, const std::string& extension);

/// Stands for a stamp that is not known.
inline constexpr double kNoStamp = std::numeric_limits<double>::quiet_NaN();

/// A stamp for each scan out of a list that begins with frame 0; kNoStamp where the list has none.
std::vector<double> stamps_by_frame(const std::vector<ScanFile>& scans, const std::vector<double>& list_s);

/// Sets the stamps of scans. Those without one are placed by the period after the last that has one (or
/// before the first; frame 0 at 0 s if none has).
/// @param stamps_s  one for each scan, kNoStamp where unknown
/// @param origin    what the stamps came from, for the warnings
/// @return what looks wrong: scans without stamps, stamps that do not grow
std::vector<std::string> set_stamps(std::vector<ScanFile>& scans, const std::vector<double>& stamps_s,
                                    double period_s, const std::string& origin);

/// Median difference [s] of successive stamps, those that do not grow left out; the fallback where there is
/// none.
double median_period_s(const std::vector<double>& stamps_s, double fallback_s);

/// Gives the dataset its scans and their stamps, and warns of files that are missing in between.
void set_scans(Dataset& dataset, std::vector<ScanFile> scans, ScanFileTraits traits);

}  // namespace mlo
