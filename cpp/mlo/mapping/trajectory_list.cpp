#include "mlo/mapping/trajectory_list.hpp"

#include <algorithm>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

constexpr double kSure = 2.0;  // standard deviations

LocalMapConfig local_map_config(const DynamicCheckConfig& config) {
  LocalMapConfig map;
  map.min_spacing_m = config.map_spacing_m;
  return map;
}

}  // namespace

std::vector<Mobility> TrajectoryList::update(std::span<const ObjectSight> sights) {
  std::vector<Entry*> entries;
  std::map<long, Entry> followed;
  for (const ObjectSight& sight : sights) {
    auto node = entries_.extract(sight.id);
    if (node.empty()) {
      entries.push_back(&followed.try_emplace(sight.id, local_map_config(config_)).first->second);
      entries.back()->T_map_object = sight.T_map_object;
    } else {
      entries.push_back(&followed.insert(std::move(node)).position->second);
    }
  }
  finished_ = maps();
  entries_ = std::move(followed);
  parallel_for_each_index(sights.size(), [&](std::size_t i) { update(*entries[i], sights[i]); });
  std::vector<Mobility> mobilities;
  for (const Entry* entry : entries) mobilities.push_back(entry->mobility);
  return mobilities;
}

std::vector<MappedObject> TrajectoryList::maps() const {
  std::vector<MappedObject> maps;
  for (const auto& [id, entry] : entries_) maps.push_back({id, entry.map.points_object()});
  return maps;
}

void TrajectoryList::archive(const TrajectoryList& self, ArchiveWriter& bytes) {
  bytes(self.finished_, self.entries_);
}

void TrajectoryList::archive(TrajectoryList& self, ArchiveReader& bytes) {
  std::size_t count = 0;
  bytes(self.finished_, count);
  self.entries_.clear();
  for (; count > 0; --count) {
    long id = 0;
    bytes(id);
    bytes(self.entries_.try_emplace(id, local_map_config(self.config_)).first->second);
  }
}

const LocalMap* TrajectoryList::map_at_rest(const Eigen::Vector3d& center_map) const {
  const auto fits = [&](const Entry& entry) {
    const double distance_m = (entry.T_map_object.translation() - center_map).head<2>().norm();
    return entry.mobility == Mobility::at_rest && entry.sightings >= config_.min_sightings &&
           entry.scans_displaced == 0 && distance_m < config_.same_place_m;
  };
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const auto& item) { return fits(item.second); });
  return found == entries_.end() ? nullptr : &found->second.at_rest;
}

void TrajectoryList::update(Entry& entry, const ObjectSight& sight) const {
  const Displacement displacement = measure_displacement(sight.points_map, entry.at_rest, config_, shapes_);
  if (entry.mobility == Mobility::at_rest) {
    update_at_rest(entry, sight, displacement);
  } else {
    update_moving(entry, sight, displacement);
  }
  if (!sight.points_map.empty()) ++entry.sightings;
  if (entry.scans_displaced == 0) entry.at_rest.insert(sight.points_map);
  const bool at_rest = entry.mobility == Mobility::at_rest;
  entry.map.insert(sight.points_map, at_rest ? entry.T_map_object : sight.T_map_object,
                   config_.map_spacing_m);
}

void TrajectoryList::update_at_rest(Entry& entry, const ObjectSight& sight,
                                    const Displacement& displacement) const {
  const bool fast = sight.moving_probability > config_.start_probability;
  // Of a map that is still young, new sides of the object look like its motion.
  const bool young = entry.sightings < config_.min_sightings;
  const bool displaced =
      young ? is_displaced_from_young_map(displacement) && entry.sightings > 1 : is_displaced(displacement);
  entry.scans_displaced = displaced ? entry.scans_displaced + 1 : 0;
  const bool starts = fast && !is_within(displacement, config_.in_place_m);
  if (!starts && entry.scans_displaced < config_.scans_displaced) return;
  entry.sightings = 0;
  entry.mobility = Mobility::moving;
  entry.too_slow_to_tell = !fast;
  entry.scans_displaced = 0;
  entry.scans_in_place = 0;
  entry.scans_still = 0;
  entry.T_map_object = sight.T_map_object;
  entry.at_rest.clear();
  entry.map.clear();
}

void TrajectoryList::update_moving(Entry& entry, const ObjectSight& sight,
                                   const Displacement& displacement) const {
  const bool fast = sight.moving_probability > config_.moving_probability;
  if (fast) entry.too_slow_to_tell = false;
  const bool displaced = is_displaced(displacement);
  // A long flat side slides along the trail that it leaves: only near its begin does that tell of a stop.
  const double way_m = (sight.T_map_object.translation() - entry.T_map_object.translation()).head<2>().norm();
  const bool elsewhere = displaced || way_m > config_.in_place_m;
  if (elsewhere) {
    entry.at_rest.clear();
    entry.T_map_object = sight.T_map_object;
  }
  entry.scans_in_place = fast || displaced ? 0 : entry.scans_in_place + 1;
  const bool still = fast && !elsewhere && is_within(displacement, config_.still_m);
  if (displacement.known) entry.scans_still = still ? entry.scans_still + 1 : 0;
  // The slow end of a motion is seen by the points only, and that takes a while.
  const bool points_tell = displacement.known && kSure * displacement.sd_m() < config_.in_place_m;
  const int scans_needed = points_tell || entry.too_slow_to_tell ? config_.scans_in_place : 1;
  if (entry.scans_in_place < scans_needed && entry.scans_still < config_.scans_still) return;
  entry.mobility = Mobility::at_rest;
  entry.sightings = 0;
  entry.T_map_object = sight.T_map_object;
}

bool TrajectoryList::is_displaced(const Displacement& displacement) const {
  return displacement.known && displacement.length_m() > config_.min_displacement_m &&
         displacement.significance() > config_.min_significance &&
         displacement.fit_after - displacement.fit_before > config_.min_fit_gain;
}

bool TrajectoryList::is_displaced_from_young_map(const Displacement& displacement) const {
  return displacement.known && displacement.length_m() > config_.min_displacement_m &&
         displacement.significance() > config_.young_significance &&
         displacement.loss_gain > config_.young_loss_gain;
}

bool TrajectoryList::is_within(const Displacement& displacement, double distance_m) const {
  return displacement.known && displacement.fit_before > config_.in_place_fit &&
         displacement.length_m() + kSure * displacement.sd_m() < distance_m;
}

}  // namespace mlo
