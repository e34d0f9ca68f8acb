#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mlo/core/object_record.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/io/kitti_box.hpp"

namespace mlo {

/// Reads a label (17 fields) or result file (18, with score) of the KITTI tracking benchmark:
/// frame id type truncation occlusion alpha left top right bottom height width length x y z rotation_y
/// [score], the box in rectified camera 0 with x, y, z at the middle of its bottom face.
/// @throws InputError naming file and line
std::vector<ObjectRecord> read_kitti_tracks(const std::filesystem::path& file);

/// Reads all .txt files of a folder, by sequence (the file's name without .txt); or a single file.
/// @throws InputError if there are none, or as read_kitti_tracks
std::map<std::string, std::vector<ObjectRecord>> read_kitti_sequences(const std::filesystem::path& path);

/// Reads a label file of the KITTI object benchmark (label_2/NNNNNN.txt): rows as above without frame and id,
/// and with truncation as a share, which becomes the steps that the benchmark tells apart: up to 15 %, 30 %,
/// 50 % (0, 1, 2), and more (3). Ids count rows; frames are 0.
/// @throws InputError naming file and line
std::vector<ObjectRecord> read_kitti_object_labels(const std::filesystem::path& file);

/// The record's 3D box as KITTI's files have it: the same numbers.
KittiBox kitti_box_of(const ObjectRecord& record);

/// Turns a lidar's axes (x ahead, y left, z up) about the camera's centre into the camera's: the frame of
/// ObjectRecord::box.
SE3 T_camera0_level();

/// Writes a result file (18 fields), in the order given; types as KITTI spells them.
/// @throws InputError when the file cannot be written
void write_kitti_tracks(const std::filesystem::path& file, std::span<const ObjectRecord> records);

}  // namespace mlo
