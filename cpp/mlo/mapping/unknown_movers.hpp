#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/se3.hpp"
#include "mlo/mapping/column_set.hpp"
#include "mlo/mapping/config.hpp"
#include "mlo/mapping/scan_view.hpp"

namespace mlo {

/// Something that moves and that no detector reports, as far as it has been seen to move.
struct UnknownMover {
  long id = 0;
  Eigen::Vector3d center_map = Eigen::Vector3d::Zero();  ///< of its points [m]
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();      ///< along the axes of the map
  Eigen::Vector2d velocity_map_mps = Eigen::Vector2d::Zero();
  std::size_t num_points = 0;

  /// The upright box of the way on which it came, itself included, x along its motion: whatever stands there
  /// now is part of it, or follows it.
  SE3 T_map_way;
  Eigen::Vector3d way_lwh_m = Eigen::Vector3d::Zero();
};

/// What moved in one scan.
struct FoundMovers {
  std::vector<UnknownMover> movers;  ///< those that were followed for long enough
  ColumnSet columns;                 ///< of everything that is where it was free before
};

/// Finds what moves without anybody's box by what earlier scans saw: where rays went through a place and
/// something is there now, it has come. All that stands where such a thing has passed belongs to it, so that
/// of a train not only the front is found. After the ever-free places of Schmid et al. (Dynablox, RA-L 2023),
/// kept as the scans that saw them instead of as a grid.
class UnknownMovers {
 public:
  UnknownMovers(const UnknownMoversConfig& config, const FreeSpaceConfig& free_space)
      : config_(config), free_space_(free_space) {}

  /// @param stamp_s     later than that of the scan before
  /// @param points_map  of the environment above the ground, map frame [m]
  FoundMovers update(double stamp_s, std::span<const Eigen::Vector3f> points_map);

  /// Keeps a scan as evidence for later ones, and forgets the oldest.
  void remember(ScanView view);

  /// All but the configuration (core/archive.hpp).
  static void archive(auto& self, auto& bytes) { bytes(self.views_, self.tracks_, self.next_id_); }

 private:
  struct Column {
    VoxelKey key;
    std::vector<Eigen::Vector3f> points_map;
    int num_young = 0;
    int num_before_sky = 0;
    bool is_new = false;
  };
  /// New columns side by side.
  struct Thing {
    Eigen::AlignedBox3d extent_map;
    Eigen::Vector3d center_map = Eigen::Vector3d::Zero();
    std::size_t num_points = 0;
    std::vector<VoxelKey> columns;
    static void archive(auto& self, auto& bytes) {
      bytes(self.extent_map.min(), self.extent_map.max(), self.center_map, self.num_points, self.columns);
    }
  };
  struct Place {
    double stamp_s = 0.0;
    Eigen::Vector3d center_map;
    static void archive(auto& self, auto& bytes) { bytes(self.stamp_s, self.center_map); }
  };
  struct Track {
    long id = 0;
    Thing thing;
    std::deque<Place> places;  // the newest last
    Eigen::Vector2d velocity_map_mps = Eigen::Vector2d::Zero();
    static void archive(auto& self, auto& bytes) {
      bytes(self.id, self.thing, self.places, self.velocity_map_mps);
    }
  };

  std::vector<Column> columns_of(std::span<const Eigen::Vector3f> points_map) const;
  enum class Age { unknown, young, young_before_sky, old };
  Age age(const Eigen::Vector3f& p_map) const;
  void judge(Column& column) const;
  std::vector<Thing> things_among(const std::vector<Column>& columns) const;
  bool moves_steadily(const Track& track) const;
  UnknownMover mover_of(const Track& track) const;
  Track follow(double stamp_s, Thing thing, std::vector<Track>& before);

  UnknownMoversConfig config_;
  FreeSpaceConfig free_space_;
  std::deque<ScanView> views_;  // the oldest first
  std::vector<Track> tracks_;
  long next_id_ = 1;
};

}  // namespace mlo
