#pragma once

#include <filesystem>
#include <vector>

#include "mlo/io/dataset.hpp"
#include "mlo/io/sequence_files.hpp"

namespace mlo {

/// The folder itself, without a name, if it holds .bin, .pcd or .ply files.
std::vector<SequenceFolder> find_plain_folder(const std::filesystem::path& folder);

/// Scans in natural order of their names ("9.pcd" before "10.pcd"); frames are the names where all of them
/// are numbers (files missing in between count), places in that order otherwise. Stamps come from
/// timestamps.txt or times.txt in the folder (a line per file, or per frame), or are 1 / rate apart. Rings
/// and times of points are the files' own where they have them, otherwise recovered as far as the order shows
/// them.
/// @throws InputError if the stamps cannot be understood
Dataset open_plain_folder(const SequenceFolder& folder, const OpenOptions& options);

}  // namespace mlo
