#pragma once

#include <map>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "mlo/core/types.hpp"

namespace mlo {

/// The map of an earlier run, from which the surroundings of the robot are taken as it goes.
class SavedMap {
 public:
  SavedMap() = default;
  explicit SavedMap(std::span<const MapPoint> points);

  /// True: there was no point to begin with.
  bool empty() const { return empty_; }
  /// Takes out the points of the tiles within a distance of a place: those that no call before has taken.
  std::vector<MapPoint> take_near(const Eigen::Vector3f& center_map, float radius_m);

  /// What was taken, for one that is made of the same points (core/archive.hpp).
  static void archive(auto& self, auto& bytes) {
    bytes(self.taken_);
    if constexpr (std::remove_reference_t<decltype(bytes)>::kReads) {
      for (const Tile& tile : self.taken_) self.tiles_.erase(tile);
    }
  }

 private:
  using Tile = std::pair<int, int>;  // its place, in tiles

  bool empty_ = true;
  std::map<Tile, std::vector<MapPoint>> tiles_;  // those not taken yet
  std::vector<Tile> taken_;
};

}  // namespace mlo
