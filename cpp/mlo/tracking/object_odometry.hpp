#pragma once

#include <deque>
#include <span>
#include <vector>

#include "mlo/core/ego_motion.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/core/sweep_motion.hpp"
#include "mlo/core/types.hpp"
#include "mlo/tracking/config.hpp"
#include "mlo/tracking/object_filter.hpp"
#include "mlo/tracking/sgf_residuals.hpp"

namespace mlo {

/// Absolute object motion in the lidar frame at the previous reference time, Eq. (14): X = delta * H^-1.
SE3 absolute_motion(const SE3& delta, const SE3& H);
/// The same in the object's own frame, Eq. (15): L^-1 * X * L.
SE3 body_fixed_motion(const SE3& L_lidar_object, const SE3& X);

/// What one scan has of an object.
struct ObjectSighting {
  std::span<const Point> points;  ///< as measured
  BoxMeasurement measurement;     ///< its box in the map frame, with noise
  double confidence = 1.0;
  SE3 T_map_lidar;
};

/// What is known of an object by other means when it is sighted again.
struct ObjectPrior {
  SE3 T_map_object;  ///< where it should be; the heading may be flipped
  Eigen::Vector3d size_lwh_m = Eigen::Vector3d::Zero();
  double moving_probability = 1.0;
  int scans_since = 1;  ///< 1 when it was seen in the scan before
};

/// Pose of one object by accumulated body-fixed motions (paper, section III-C-3), each estimated from points
/// and boxes of the last sighting and the present one.
class ObjectOdometry {
 public:
  /// To be read from an archive.
  ObjectOdometry() = default;
  /// The first pose is that of the box.
  ObjectOdometry(const ObjectSighting& first, const SweepTiming& timing, const SgfConfig& config);

  /// Continues by one sighting. Of an object that stands only a part of the estimated motion counts
  /// (SgfConfig::standing_gain), so that its pose becomes a mean over its sightings.
  /// @return T_target_source is the relative motion H since the last sighting; when it is not usable, the
  /// prior counts
  PoseEstimate update(const ObjectSighting& sighting, const ObjectPrior& prior, const SweepTiming& timing,
                      const SgfConfig& config);

  /// At the last sighting.
  const SE3& T_map_object() const { return T_map_object_; }
  /// From the sighting before to the last, as estimated, whatever part of it counted [m].
  const Eigen::Vector3d& moved_map_m() const { return moved_map_m_; }
  /// Front becomes back.
  void turn_round();

  static void archive(auto& self, auto& bytes) {  // core/archive.hpp
    bytes(self.T_map_object_, self.moved_map_m_, self.T_map_lidar_, self.last_box_lidar_,
          self.points_object_);
  }

 private:
  std::vector<ShapedPoint> shape(const ObjectSighting& sighting, int scans_since,
                                 const SweepTiming& timing) const;
  void move_on(const SE3& body_fixed, double moving_probability, const SgfConfig& config);
  void remember(std::vector<ShapedPoint> points, const SE3& H, const SE3& L_lidar_object,
                const SgfConfig& config);
  ObjectTarget target(const SE3& L_lidar_object, const SgfConfig& config) const;

  SE3 T_map_object_;
  Eigen::Vector3d moved_map_m_ = Eigen::Vector3d::Zero();
  SE3 T_map_lidar_;                                     ///< at the last sighting
  Box3d last_box_lidar_;                                ///< the detector's, at the last sighting
  std::deque<std::vector<ShapedPoint>> points_object_;  ///< of earlier sightings, in the object's frame
};

}  // namespace mlo
