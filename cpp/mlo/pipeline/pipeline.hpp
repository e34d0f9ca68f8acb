#pragma once

#include <memory>
#include <optional>
#include <span>

#include "mlo/core/box.hpp"
#include "mlo/core/features.hpp"
#include "mlo/core/sweep_motion.hpp"
#include "mlo/core/types.hpp"
#include "mlo/detection/detect.hpp"
#include "mlo/mapping/local_map.hpp"
#include "mlo/mapping/mover_trails.hpp"
#include "mlo/mapping/refinement.hpp"
#include "mlo/mapping/saved_map.hpp"
#include "mlo/mapping/static_map.hpp"
#include "mlo/mapping/trajectory_list.hpp"
#include "mlo/mapping/unknown_movers.hpp"
#include "mlo/odometry/reference_scan.hpp"
#include "mlo/odometry/two_step_ego.hpp"
#include "mlo/perception/ground.hpp"
#include "mlo/pipeline/config.hpp"
#include "mlo/pipeline/frame_result.hpp"
#include "mlo/tracking/tracker.hpp"

namespace mlo {

/// The whole system, scan by scan (the paper's Fig. 2). Not thread-safe; runs on the caller's TBB arena.
class Pipeline {
 public:
  /// @throws InputError if the detector of the configuration needs a network whose weights cannot be used
  explicit Pipeline(const PipelineConfig& config);
  /// Localises in the map of an earlier run and makes none: the map frame is that map's. Until the place is
  /// found, each scan is looked for around where it should be, and objects are not followed.
  /// @param T_map_lidar_start  where the first scan was taken, roughly (PlaceSearchConfig)
  Pipeline(const PipelineConfig& config, std::span<const MapPoint> map, const SE3& T_map_lidar_start);

  /// Takes the next scan and the boxes that a detector found in it. Scans come in the order of time; gaps are
  /// allowed. After three scans in a row that are not found in the local maps, these begin anew at the
  /// predicted pose.
  FrameResult process(const Scan& scan, std::span<const Detection> detections);
  /// The same where nobody gives boxes: the detector of the configuration looks for them.
  FrameResult process(const Scan& scan);

  /// Poses by constant motion, this many sweeps after the last scan that was processed.
  PredictedPoses predict_poses(double sweeps_ahead) const;

  /// Of the detector; nothing if it needs none.
  const Network* network() const { return network_.get(); }
  const StaticMap& static_map() const { return static_map_; }
  /// Of the objects that are followed; those of others were in FrameResult::finished_objects.
  std::vector<MappedObject> object_maps() const;

  /// Everything that later results depend on but the configuration (core/archive.hpp): a pipeline of the same
  /// configuration that reads it goes on as this one would.
  static void archive(auto& self, auto& bytes) {
    bytes(self.state_, self.local_maps_, self.static_map_, self.unknown_movers_, self.mover_trails_,
          self.saved_map_, self.trajectories_, self.tracker_);
  }

 private:
  /// What one scan leaves to the next; replaced as a whole at the end of process().
  struct State {
    bool empty = true;
    bool placed = false;        ///< in the map: from the first scan on, or once it was found in a saved one
    bool motion_known = false;  ///< false until a first increment was estimated, and after a failure
    std::size_t frame = 0;
    double stamp_s = 0.0;
    SE3 T_odom_lidar;         ///< at the reference time of the last scan
    SE3 T_map_lidar;          ///< the same, refined
    SE3 T_sweep;              ///< motion of the last sweep, from its start to its end
    ReferenceScan reference;  ///< last scan's candidates without distortion
    int scans_lost = 0;       ///< in a row, up to this one; scans too empty to be placed do not count
    std::vector<Detection> likely_objects;  ///< the detector's, for the next scan to look back at
    std::optional<Percept> unplaced;  ///< the first scan while its motion, and so its distortion, is unknown
    static void archive(auto& self, auto& bytes) {
      bytes(self.empty, self.placed, self.motion_known, self.frame, self.stamp_s, self.T_odom_lidar,
            self.T_map_lidar, self.T_sweep, self.reference, self.scans_lost, self.likely_objects,
            self.unplaced);
    }
  };

  /// One map, or one per class (LocalMapConfig::separate_classes).
  struct LocalMaps {
    LocalMap ground, edge, surface;
    static void archive(auto& self, auto& bytes) { bytes(self.ground, self.edge, self.surface); }
  };

  /// The candidates of a scan in the map frame [m], in their order.
  struct PlacedCandidates {
    std::vector<Eigen::Vector3f> ground, edge, surface;
  };

  /// @param given  boxes, or nothing: they are looked for
  FrameResult process_scan(const Scan& scan, std::optional<std::span<const Detection>> given);
  FoundObjects find_objects(const Scan& prepared, const GroundSegmentation& ground) const;
  SweepTiming timing(const Scan& scan) const;
  SE3 predict(const SweepTiming& timing) const;
  EgoOdometryResult estimate_increment(const Percept& seen, const SE3& prediction, const SweepTiming& timing,
                                       std::size_t frame) const;
  PoseEstimate refine_pose(const Percept& seen, const SE3& T_previous_current, bool motion_known,
                           const SweepTiming& timing);
  std::vector<TrackedObject> track(const Scan& scan, const Percept& seen, const SE3& T_map_lidar,
                                   const SweepTiming& timing);
  struct ObjectAtRest {
    std::vector<FeaturePoint> points;
    const LocalMap* map;
  };
  std::vector<ObjectAtRest> find_objects_at_rest(const Percept& seen, const SE3& T_previous_current) const;
  SE3 sweep_increment(const SE3& T_odometry, const SE3& T_map_lidar) const;
  void find_moving(const Percept& seen, const SweepMotion& motion, const SE3& T_map_lidar,
                   std::vector<TrackedObject>& objects);
  PoseEstimate refine_in_saved_map(std::span<const RefinementTerm> terms, const RefinementGuess& guess);
  void insert_saved_map_near(const Eigen::Vector3f& center_map);
  void clear_maps();
  void clear_local_maps();
  bool local_maps_are_empty() const;
  static PlacedCandidates place(const Percept& seen, const SweepMotion& motion, const SE3& T_map_lidar);
  std::vector<MapPoint> insert_in_local_maps(const Percept& seen, const PlacedCandidates& in_map,
                                             const SE3& T_map_lidar);

  FoundMovers find_unknown_movers(double stamp_s, const PlacedCandidates& in_map);
  void update_static_map(const Scan& scan, std::span<const MapPoint> unmapped, const SweepMotion& motion,
                         const SE3& T_map_lidar, std::span<const TrackedObject> objects,
                         const FoundMovers& unknown);
  std::vector<Box3d> follow_trails(const Scan& scan, const SE3& T_map_lidar,
                                   std::span<const TrackedObject> objects,
                                   std::span<const UnknownMover> unknown_movers);
  /// @param next  with stamp, poses and motion of this scan; the rest is filled in
  void commit(const Scan& scan, const Percept& seen, const SweepMotion& motion, State next,
              FrameResult& result);

  PipelineConfig config_;
  std::shared_ptr<const Network> network_;  ///< of the detector, if it needs one
  State state_;
  LocalMaps local_maps_;
  StaticMap static_map_;
  UnknownMovers unknown_movers_;
  MoverTrails mover_trails_;
  SavedMap saved_map_;  // empty: a map is made
  TrajectoryList trajectories_;
  Tracker tracker_;
};

}  // namespace mlo
