#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mlo/core/object_pose.hpp"

namespace mlo {

struct ObjectTrajectoryOptions {
  double max_distance_m = 2.0;  ///< centres farther apart do not belong together
  /// True poses with fewer returns are not demanded, where the truth says how many there are.
  std::size_t min_points = 5;
  double subpath_m = 1.0;  ///< relative errors are those of true sub-paths of at least this length
};

/// One true object over its whole life. Errors are of the one track that was given to it.
struct ObjectErrors {
  long truth_id = 0;
  std::string type;
  std::optional<long> track_id;    ///< none: lost
  std::size_t truth_frames = 0;    ///< in which it was to be tracked
  std::size_t tracked_frames = 0;  ///< of these, with its track no farther than the gate
  std::size_t other_frames = 0;    ///< with another track there instead
  std::size_t missed_frames = 0;   ///< without any
  std::size_t switches = 0;        ///< changes from one track to another, gaps in between or not
  double truth_path_m = 0.0;       ///< way of the object over the frames demanded

  /// RMSE of positions after the rigid alignment of the trajectory that minimises it (as for the ego).
  std::optional<double> ate_m;
  /// The same without alignment: drift of the map frame included.
  std::optional<double> position_rmse_m;
  /// Mean over sub-paths i, j of at least subpath_m: norm of translation and angle of
  /// E = (T_i^-1 T_j)^-1 (P_i^-1 P_j), divided by the length. None where the object travels less.
  std::optional<double> rte_m_per_m;
  std::optional<double> rre_deg_per_m;
};

struct ObjectEvaluation {
  std::vector<ObjectErrors> objects;        ///< in the order of their ids
  std::vector<long> tracks_without_object;  ///< ids that no true object was given
};

/// Gives each true object at most one track, for its whole life and one to one, so that as many frames as
/// possible agree within the gate (as identity scores do; Ristani et al., 2016), and measures its trajectory
/// over all frames that both have, also where they are apart.
/// @param truth, tracks  poses in map frames that coincide; each sorted by frame and id, which occurs once
/// per
///   frame; poses that are not finite are left out
ObjectEvaluation evaluate_objects(std::span<const ObjectPose> truth, std::span<const ObjectPose> tracks,
                                  const ObjectTrajectoryOptions& options = {});

/// Means over the objects that have the measure, and sums of the counts.
struct ObjectSummary {
  std::size_t objects = 0;
  std::size_t lost = 0;      ///< without a track of their own
  std::size_t switched = 0;  ///< with at least one switch
  std::size_t switches = 0;
  std::size_t truth_frames = 0;
  std::size_t tracked_frames = 0;
  std::size_t other_frames = 0;
  std::size_t missed_frames = 0;
  std::optional<double> ate_m;
  std::optional<double> position_rmse_m;
  std::optional<double> rte_m_per_m;
  std::optional<double> rre_deg_per_m;
};
ObjectSummary summarise(std::span<const ObjectErrors> objects);

}  // namespace mlo
