#include "mlo/mapping/mover_trails.hpp"

#include <algorithm>
#include <ranges>
#include <utility>

namespace mlo {
namespace {

SE3 moved_on(const SE3& T_map_object, const Eigen::Vector2d& velocity_map_mps, double dt_s) {
  const Eigen::Vector2d way_m = dt_s * velocity_map_mps;
  return {T_map_object.rotation(), T_map_object.translation() + Eigen::Vector3d(way_m.x(), way_m.y(), 0.0)};
}

}  // namespace

Trails MoverTrails::update(std::size_t frame, double stamp_s, std::span<const TrailedObject> objects) {
  Trails trails;
  std::map<long, TrailedObject> movers;
  PastScan scan{.frame = frame, .stamp_s = stamp_s, .T_map_object = {}};
  for (const TrailedObject& object : objects) {
    scan.T_map_object.emplace(object.id, object.T_map_object);
    if (!object.moves) continue;
    movers.emplace(object.id, object);
    if (movers_.contains(object.id)) continue;
    const std::vector<TrailPlace> before = trail_before(object, stamp_s);
    trails.before.insert(trails.before.end(), before.begin(), before.end());
  }
  for (const auto& [id, object] : movers_) {
    if (!scan.T_map_object.contains(id)) lost_.push_back({object, scans_.back().stamp_s});
  }
  std::erase_if(lost_, [&](const LostObject& lost) { return stamp_s - lost.stamp_s > length_s_; });
  for (const auto& [object, lost_s] : lost_) {
    trails.now.push_back(
        {.frame = frame,
         .T_map_object = moved_on(object.T_map_object, object.velocity_map_mps, stamp_s - lost_s),
         .size_lwh_m = object.size_lwh_m});
  }
  scans_.push_back(std::move(scan));
  while (stamp_s - scans_.front().stamp_s > length_s_) scans_.pop_front();
  movers_ = std::move(movers);
  return trails;
}

std::vector<TrailPlace> MoverTrails::trail_before(const TrailedObject& object, double stamp_s) const {
  std::vector<TrailPlace> places;
  SE3 T_map_object = object.T_map_object;
  double known_s = stamp_s;
  for (const auto& scan : std::views::reverse(scans_)) {
    if (stamp_s - scan.stamp_s > length_s_) break;
    const auto own = scan.T_map_object.find(object.id);
    if (own != scan.T_map_object.end()) {
      T_map_object = own->second;
      known_s = scan.stamp_s;
    }
    places.push_back({.frame = scan.frame,
                      .T_map_object = moved_on(T_map_object, object.velocity_map_mps, scan.stamp_s - known_s),
                      .size_lwh_m = object.size_lwh_m});
  }
  return places;
}

}  // namespace mlo
