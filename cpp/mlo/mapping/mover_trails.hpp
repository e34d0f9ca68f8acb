#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/archive.hpp"
#include "mlo/core/se3.hpp"

namespace mlo {

/// An object of one scan, as far as its trail depends on it.
struct TrailedObject {
  long id = 0;
  SE3 T_map_object;
  Eigen::Vector3d size_lwh_m = Eigen::Vector3d::Zero();
  Eigen::Vector2d velocity_map_mps = Eigen::Vector2d::Zero();
  bool moves = false;
  static void archive(auto& self, auto& bytes) {  // core/archive.hpp
    bytes(self.id, self.T_map_object, self.size_lwh_m, self.velocity_map_mps, self.moves);
  }
};

/// Where an object was, or will have been, in a scan.
struct TrailPlace {
  std::size_t frame = 0;
  SE3 T_map_object;
  Eigen::Vector3d size_lwh_m = Eigen::Vector3d::Zero();
};

/// Where things that move are in scans in which nobody says so.
struct Trails {
  std::vector<TrailPlace> before;  ///< of those that were found to move just now, in earlier scans
  std::vector<TrailPlace> now;     ///< of those that were lost, in this scan
};

/// Follows what moves beyond the scans in which it is known to: back to before it was found, and on after it
/// was lost. Where it had no pose of its own, it is taken to move at constant velocity.
class MoverTrails {
 public:
  /// @param length_s  how far back and on [s]; 0: not at all
  explicit MoverTrails(double length_s) : length_s_(length_s) {}

  /// @param stamp_s  later than that of the scan before
  /// @param objects  all that are followed, in motion or not
  Trails update(std::size_t frame, double stamp_s, std::span<const TrailedObject> objects);

  /// All but the configuration (core/archive.hpp).
  static void archive(auto& self, auto& bytes) { bytes(self.scans_, self.movers_, self.lost_); }

 private:
  struct PastScan {
    std::size_t frame = 0;
    double stamp_s = 0.0;
    std::map<long, SE3> T_map_object;
    static void archive(auto& self, auto& bytes) { bytes(self.frame, self.stamp_s, self.T_map_object); }
  };
  struct LostObject {
    TrailedObject object;
    double stamp_s = 0.0;  // when it was followed last
    static void archive(auto& self, auto& bytes) { bytes(self.object, self.stamp_s); }
  };

  std::vector<TrailPlace> trail_before(const TrailedObject& object, double stamp_s) const;

  double length_s_;
  std::deque<PastScan> scans_;            // the oldest first
  std::map<long, TrailedObject> movers_;  // of the last scan
  std::vector<LostObject> lost_;
};

}  // namespace mlo
