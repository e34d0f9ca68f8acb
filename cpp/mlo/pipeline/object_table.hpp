#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "mlo/io/dataset.hpp"
#include "mlo/tracking/tracker.hpp"

namespace mlo {

/// Where and when an object was seen.
struct ObjectRow {
  std::size_t frame = 0;
  double stamp_s = 0.0;
};

/// Header and rows of objects.csv, without line ends: the columns of docs/evaluation.md (pose in the map
/// frame) and beside them track_state, velocity and turn rate, probability that it moves, standard deviations
/// of these and of the pose, box in the lidar frame, log-odds of existence, hits, misses and the status of
/// the motion estimate.
std::string object_table_header();
std::string object_table_row(const ObjectRow& place, const TrackedObject& object);

/// Collects the map poses of reported objects, by id, and writes them as TUM files.
class ObjectTrajectories {
 public:
  void add(const ObjectRow& place, long id, const SE3& T_map_object);
  bool contains(long id) const { return by_id_.contains(id); }
  /// FOLDER/00012.txt for the object with id 12; the folder is made if missing.
  /// @throws InputError when a file cannot be written
  void write(const std::filesystem::path& folder) const;
  static void archive(auto& self, auto& bytes) { bytes(self.by_id_); }  // core/archive.hpp

 private:
  std::map<long, PoseList> by_id_;
};

}  // namespace mlo
