#include "mlo/mapping/trajectory_list.hpp"

#include <algorithm>

#include "mlo/core/parallel.hpp"
#include "mlo/mapping/motion_belief.hpp"

namespace mlo {
namespace {

constexpr double kSure = 2.0;      // standard deviations
constexpr double kInDoubt = -1.0;  // belief in a start, beyond which points do not enter the map at rest

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
           !entry.in_doubt && distance_m < config_.same_place_m;
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
  if (!entry.in_doubt) entry.at_rest.insert(sight.points_map);
  const bool at_rest = entry.mobility == Mobility::at_rest;
  entry.map.insert(sight.points_map, at_rest ? entry.T_map_object : sight.T_map_object,
                   config_.map_spacing_m);
}

void TrajectoryList::update_at_rest(Entry& entry, const ObjectSight& sight,
                                    const Displacement& displacement) const {
  const bool fast = sight.moving_probability > config_.start_probability;
  bool starts = fast;
  entry.in_doubt = false;
  if (displacement.known) {
    const double belief = belief_in_start(entry, sight, displacement);
    starts = belief > 0.0;
    entry.in_doubt = belief > kInDoubt;
  }
  if (!starts) return;
  entry.sightings = 0;
  entry.mobility = Mobility::moving;
  entry.too_slow_to_tell = !fast;
  entry.in_doubt = false;
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
  const bool still = fast && !elsewhere && is_still(displacement);
  if (displacement.known) entry.scans_still = still ? entry.scans_still + 1 : 0;
  // The slow end of a motion is seen by the points only, and that takes a while.
  const bool points_tell = displacement.known && kSure * displacement.sd_m() < config_.in_place_m;
  const int scans_needed = points_tell || entry.too_slow_to_tell ? config_.scans_in_place : 1;
  if (entry.scans_in_place < scans_needed && entry.scans_still < config_.scans_still) return;
  entry.mobility = Mobility::at_rest;
  entry.sightings = 0;
  entry.T_map_object = sight.T_map_object;
}

double TrajectoryList::belief_in_start(const Entry& entry, const ObjectSight& sight,
                                       const Displacement& displacement) const {
  // A speed that the points deny is that of a box that jumped.
  const double by_speed =
      is_still(displacement) ? std::min(sight.moving_probability, 0.5) : sight.moving_probability;
  const auto belief_with = [&](const MapFit& map) {
    return motion_belief(by_speed, displacement, map, config_.start);
  };
  // The map's answer costs as much as the displacement did: it is asked only if it can matter.
  constexpr MapFit kMost{.misfit = 1.0, .gain = 1.0};
  const double most = belief_with(kMost);
  if (most < kInDoubt) return most;
  return belief_with(fit_map(entry.map.points_object(), entry.T_map_object, sight.points_map, displacement,
                             config_, shapes_));
}

bool TrajectoryList::is_displaced(const Displacement& displacement) const {
  return displacement.known && displacement.length_m() > config_.min_displacement_m &&
         displacement.significance() > config_.min_significance;
}

bool TrajectoryList::is_still(const Displacement& displacement) const {
  return displacement.known && displacement.length_m() + kSure * displacement.sd_m() < config_.still_m;
}

}  // namespace mlo
