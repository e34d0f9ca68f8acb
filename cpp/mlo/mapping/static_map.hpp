#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <tsl/robin_map.h>

#include "mlo/core/archive.hpp"
#include "mlo/core/box.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/core/types.hpp"
#include "mlo/core/voxel_grid.hpp"
#include "mlo/mapping/column_set.hpp"
#include "mlo/mapping/config.hpp"
#include "mlo/mapping/scan_view.hpp"
#include "mlo/mapping/spool.hpp"
#include "mlo/mapping/voxel_block.hpp"

namespace mlo {

/// What of a scan is left out of the static map.
struct LeftOut {
  SE3 T_map_lidar;                 ///< where it was seen from
  std::vector<Box3d> moving = {};  ///< what moves, in the lidar frame: points in or near these boxes
  ColumnSet columns = {};          ///< of things that move without a box: all but the ground in them
};

/// The long-term static map: environment points of all scans, one per voxel, without the points of objects
/// and without what later scans looked through.
class StaticMap {
 public:
  explicit StaticMap(const StaticMapConfig& config, const FreeSpaceConfig& free_space = {});

  /// Adds points of a scan, each where no point is yet. Of those that share a voxel the first stays.
  /// @param frame  of the scan
  void insert(std::span<const MapPoint> points, std::size_t frame, const LeftOut& left_out = {});

  /// Lets a scan vote on the points of the map: for those that it sees, against those that it sees through.
  void observe(const ScanView& view);

  /// Takes back what one scan brought within an upright box and the margin around it; later scans may fill
  /// its voxels anew. Parts that wait on disk stay as they are.
  /// @param frame         of the scan
  /// @param T_map_object  of the middle of the box, x ahead
  void take_back(std::size_t frame, const SE3& T_map_object, const Eigen::Vector3d& size_lwh_m);

  /// Puts the parts that are far from a place (map frame [m]) on disk. They come back when they are needed.
  /// @throws InputError when the temporary files cannot be written
  void spool_far(const Eigen::Vector3f& center_map);

  /// Voxels with a point, those that were seen through among them.
  std::size_t size() const;
  /// The points that were not seen through, without those among them that were hardly seen themselves, in an
  /// order that depends only on what was inserted and observed.
  std::vector<MapPoint> points() const;
  /// The same, with the points of each scan moved in the map frame, and then one for each voxel.
  /// @param corrections  by the frame of the scan that a point is from; the others stay
  std::vector<MapPoint> moved_points(const std::map<std::size_t, SE3>& corrections) const;

  /// All but the configuration (core/archive.hpp), what waits on disk too.
  static void archive(const StaticMap& self, ArchiveWriter& bytes);
  static void archive(StaticMap& self, ArchiveReader& bytes);

 private:
  struct Entry {
    MapPoint point;
    float votes = 0.0F;  // for being there
    std::uint32_t frame = 0;
    std::uint8_t skies = 0;  // in a row, scans that saw the sky there
    static void archive(auto& self, auto& bytes) { bytes(self.point, self.votes, self.frame, self.skies); }
  };
  /// A column of the map: what is near the robot is found by its tiles.
  struct Tile {
    VoxelBlocks index;           // into entries
    std::vector<Entry> entries;  // empty while on disk
    VoxelKey key;
    std::uint64_t place = 0;      // on disk
    std::size_t num_spooled = 0;  // entries there; 0: the tile is in memory
  };

  /// Indices of a scan's points that are in one tile, by the tile's place in tiles_.
  using PointsOfTiles = tsl::robin_map<std::uint32_t, std::vector<std::uint32_t>>;
  bool is_left_out(const MapPoint& point, const LeftOut& left_out, const SE3& T_lidar_map) const;
  PointsOfTiles by_tiles(std::span<const MapPoint> points, const LeftOut& left_out);
  void insert(Tile& tile, std::span<const MapPoint> points, std::span<const std::uint32_t> chosen,
              std::uint32_t frame) const;
  /// Points that were seen through in each block of space that has some.
  using Counts = tsl::robin_map<VoxelKey, int, VoxelKeyHash>;
  Counts count_seen_through() const;
  std::uint32_t tile_at(const VoxelKey& key);
  void spool(Tile& tile);
  void fetch(Tile& tile) const;
  void make_index(Tile& tile) const;
  std::vector<Entry> entries_of(const Tile& tile) const;
  void observe(Tile& tile, const ScanView& view) const;
  template <class IsInside>
  void take_back(Tile& tile, std::size_t frame, const IsInside& is_inside);
  template <class Use>
  void for_each_kept(const Use& use) const;
  void vote(Entry& entry, Sight sight) const;
  static bool is_seen_through(const Entry& entry) { return entry.votes < 0.0F; }

  StaticMapConfig config_;
  FreeSpaceConfig free_space_;
  float inverse_voxel_;
  tsl::robin_map<VoxelKey, std::uint32_t, VoxelKeyHash> tile_index_;
  std::vector<Tile> tiles_;
  Spool spool_;
};

}  // namespace mlo
