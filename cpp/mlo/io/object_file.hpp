#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mlo/core/object_pose.hpp"

namespace mlo {

/// Reads objects.csv: a header line, then a row per scan and object. Columns are found by name, in any order:
/// frame, id, class, x_m, y_m, z_m, qx, qy, qz, qw are needed (pose in the map frame); stamp_s, state,
/// length_m, width_m, height_m, points and visible_share are used where they are there; others are passed
/// over. The rows come sorted by frame and id.
/// @throws InputError naming file and line: a missing column, a value that is no number, a rotation that is
///   none, an id that stands twice in a frame
std::vector<ObjectPose> read_objects_csv(const std::filesystem::path& file);

/// The header line and a row of objects.csv as this program writes it, without line ends; what is not known
/// is left empty.
std::string objects_csv_header();
std::string objects_csv_row(const ObjectPose& object);

/// @throws InputError if the file cannot be written
void write_objects_csv(const std::filesystem::path& file, std::span<const ObjectPose> objects);

}  // namespace mlo
