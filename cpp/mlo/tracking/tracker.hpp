#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/ego_motion.hpp"
#include "mlo/core/features.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/core/sweep_motion.hpp"
#include "mlo/tracking/association.hpp"
#include "mlo/tracking/config.hpp"
#include "mlo/tracking/lifecycle.hpp"
#include "mlo/tracking/object_filter.hpp"
#include "mlo/tracking/object_odometry.hpp"
#include "mlo/tracking/placed_box.hpp"
#include "mlo/tracking/report_belief.hpp"

namespace mlo {

/// A track as it stands after a scan.
struct TrackedObject {
  long id = 0;
  ObjectClass object_class = ObjectClass::car;
  TrackState state = TrackState::tentative;
  bool reported = false;  ///< confirmed or coasting, and believed
  Box3d box;              ///< in the lidar frame
  SE3 T_map_object;
  Eigen::Vector2d velocity_map_mps = Eigen::Vector2d::Zero();
  double turn_rate_radps = 0.0;
  double moving_probability = 0.5;
  bool moving = false;
  /// Of [x; y; vx; vy] in the map frame, [m] and [m/s].
  ObjectFilter::Matrix4d planar_covariance = ObjectFilter::Matrix4d::Zero();
  Eigen::Matrix2d yaw_covariance = Eigen::Matrix2d::Zero();  ///< of [yaw; turn rate], [rad] and [rad/s]
  double existence = 0.0;                                    ///< log-odds
  double belief = 0.0;                                       ///< log-odds that the box is an object's
  int age = 0;                                               ///< scans since the first detection, with it
  int hits = 0;
  int misses = 0;                        ///< in a row
  std::optional<std::size_t> detection;  ///< index of this scan's detection; nothing when predicted
  std::size_t num_points = 0;            ///< in this scan's box
  /// Estimate of H in this scan, from the last one in which the object was seen; "not run" without points.
  PoseEstimate relative_motion;
};

/// Follows boxes from scan to scan (paper, section III-C-2), on line: the result of a scan depends on it and
/// earlier ones only.
class Tracker {
 public:
  explicit Tracker(const TrackingConfig& config) : config_(config) {}

  /// @param detections    of one scan, in the lidar frame; boxes that are not finite are left out
  /// @param T_map_lidar  pose of the lidar at that scan
  /// @param dt_s          time since the scan before; scans without detections must be given too
  /// @return all tracks that live, by id
  std::vector<TrackedObject> process(std::span<const Detection> detections, const SE3& T_map_lidar,
                                     double dt_s);

  /// The same where nothing is known of the lidar's motion: it is estimated from the boxes themselves, of
  /// which most stand or move along with others (ego_from_boxes.hpp).
  std::vector<TrackedObject> process(std::span<const Detection> detections, double dt_s);

  /// The same with the objects' points: the pose of each is then accumulated from its motions by
  /// semantic-geometric fusion (paper, section III-C-2 and -3), which also tell its velocity. Objects run in
  /// parallel; the result does not depend on the number of threads.
  std::vector<TrackedObject> process(std::span<const ObjectPoints> objects, const SE3& T_map_lidar,
                                     double dt_s, const SweepTiming& timing);

  /// Pose of the lidar at the last scan, as given or estimated.
  const SE3& T_map_lidar() const { return T_map_lidar_; }

  /// All but the configuration (core/archive.hpp).
  static void archive(auto& self, auto& bytes) {
    bytes(self.tracks_, self.usual_width_, self.T_map_lidar_, self.last_increment_, self.started_,
          self.next_id_);
  }

 private:
  struct Track {
    long id = 0;
    ObjectClass object_class = ObjectClass::car;
    ObjectFilter filter = {};
    TrackState state = TrackState::tentative;
    double existence = 0.0;
    double best_logit = 0.0;  ///< of its detections
    double logit = 0.0;       ///< of this scan's detection; 0 without
    double belief = 0.0;      ///< log-odds that its box is an object's
    int age = 1;
    int hits = 1;
    int misses = 0;
    std::optional<std::size_t> detection;
    int misses_before = 0;  ///< in a row, before this scan
    std::size_t num_points = 0;
    std::optional<ObjectOdometry> odometry = {};
    PoseEstimate relative_motion = {};
    static void archive(auto& self, auto& bytes) {
      bytes(self.id, self.object_class, self.filter, self.state, self.existence, self.best_logit, self.logit,
            self.belief, self.age, self.hits, self.misses, self.detection, self.misses_before,
            self.num_points, self.odometry, self.relative_motion);
    }
  };

  /// Detections as the tracks see them; index leads to the span that was given.
  struct Observation {
    BoxMeasurement measurement;
    ObjectClass object_class;
    double logit;
    double range_m;
    std::size_t index;
    bool taken = false;
  };

  std::vector<Observation> observe(std::span<const Detection> detections, const SE3& T_map_lidar) const;
  SE3 estimate_pose(std::span<const Detection> detections) const;
  void commit(std::vector<Observation> observations);
  void update_odometry(Track& track, const ObjectPoints& object, double dt_s, const SweepTiming& timing);
  std::vector<TrackedObject> describe_all() const;
  void learn_usual_width(std::span<const Observation> observations);
  void judge(Track& track) const;
  void associate_and_update(std::vector<Observation>& observations, bool high_confidence);
  void miss_unmatched();
  void begin_tracks(std::vector<Observation> observations);
  void end_tracks();
  TrackedObject describe(const Track& track) const;

  TrackingConfig config_;
  std::vector<Track> tracks_;
  UsualCarWidth usual_width_;
  SE3 T_map_lidar_;
  SE3 last_increment_;
  bool started_ = false;
  long next_id_ = 1;
};

}  // namespace mlo
