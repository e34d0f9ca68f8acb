#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/archive.hpp"
#include "mlo/core/labelled_point.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/mapping/config.hpp"
#include "mlo/mapping/displacement.hpp"
#include "mlo/mapping/local_map.hpp"
#include "mlo/mapping/object_map.hpp"

namespace mlo {

/// One object in one scan, as tracking has it.
struct ObjectSight {
  long id = 0;
  SE3 T_map_object;
  double moving_probability = 0.5;               ///< by its speed
  std::vector<Eigen::Vector3f> points_map = {};  ///< of this scan, map frame [m]; empty when it was not seen
};

/// The map of an object that is no longer followed, or of one that is.
struct MappedObject {
  long id = 0;
  std::vector<Eigen::Vector3f> points_object;  ///< in its own frame [m]
  static void archive(auto& self, auto& bytes) { bytes(self.id, self.points_object); }  // core/archive.hpp
};

/// The absolute trajectory tracking list (ATTL) of the paper, section III-D-1: which objects move, by their
/// speed and by how far their points lie from where they were at rest, and a map of each.
class TrajectoryList {
 public:
  TrajectoryList(const DynamicCheckConfig& config, const RefinementConfig& shapes)
      : config_(config), shapes_(shapes) {}

  /// Takes the objects of the next scan; those that are not among them are forgotten. Objects run in
  /// parallel.
  /// @return whether each moves, in their order
  std::vector<Mobility> update(std::span<const ObjectSight> sights);

  /// The map of the object that has rested at a place (map frame [m]) for long enough to help localisation;
  /// null where there is none.
  const LocalMap* map_at_rest(const Eigen::Vector3d& center_map) const;

  /// Maps of the objects that the last update forgot.
  std::vector<MappedObject> take_finished() { return std::exchange(finished_, {}); }
  /// Maps of those that are followed.
  std::vector<MappedObject> maps() const;

  /// All but the configuration (core/archive.hpp).
  static void archive(const TrajectoryList& self, ArchiveWriter& bytes);
  static void archive(TrajectoryList& self, ArchiveReader& bytes);

 private:
  struct Entry {
    explicit Entry(const LocalMapConfig& config) : at_rest(config) {}
    Mobility mobility = Mobility::at_rest;  // at first sight
    int sightings = 0;                      // at rest, or in motion
    bool in_doubt = false;                  // may have begun to move
    bool too_slow_to_tell = false;          // moves, but only its displacement shows it
    int scans_in_place = 0;                 // in a row, while moving
    int scans_still = 0;                    // the same, by its points alone
    SE3 T_map_object;                       // the oldest pose at rest, or where at_rest begins
    LocalMap at_rest;                       // its points while it rests, or moves little; map frame
    ObjectMap map;
    static void archive(auto& self, auto& bytes) {
      bytes(self.mobility, self.sightings, self.in_doubt, self.too_slow_to_tell, self.scans_in_place,
            self.scans_still, self.T_map_object, self.at_rest, self.map);
    }
  };

  void update(Entry& entry, const ObjectSight& sight) const;
  void update_at_rest(Entry& entry, const ObjectSight& sight, const Displacement& displacement) const;
  void update_moving(Entry& entry, const ObjectSight& sight, const Displacement& displacement) const;
  double belief_in_start(const Entry& entry, const ObjectSight& sight,
                         const Displacement& displacement) const;
  bool is_displaced(const Displacement& displacement) const;
  bool is_still(const Displacement& displacement) const;

  DynamicCheckConfig config_;
  RefinementConfig shapes_;
  std::map<long, Entry> entries_;
  std::vector<MappedObject> finished_;
};

}  // namespace mlo
