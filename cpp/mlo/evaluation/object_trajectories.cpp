#include "mlo/evaluation/object_trajectories.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mlo/core/assignment.hpp"
#include "mlo/evaluation/measures.hpp"
#include "mlo/evaluation/trajectory_error.hpp"

namespace mlo {
namespace {

constexpr double kForbidden = 1e9;  // more than all distances of a frame together

using Place = std::size_t;

// Poses of one object by frame.
struct Life {
  long id = 0;
  std::string type;
  std::map<std::size_t, SE3> T_map_object;
};

bool is_demanded(const ObjectPose& pose, std::size_t min_points) {
  return pose.T_map_object.is_finite() && (!pose.points || *pose.points >= min_points);
}

std::vector<Life> lives_of(std::span<const ObjectPose> poses, std::size_t min_points) {
  std::map<long, Life> lives;
  for (const ObjectPose& pose : poses) {
    if (!is_demanded(pose, min_points)) continue;
    Life& life = lives[pose.id];
    life.id = pose.id;
    life.type = pose.type;
    life.T_map_object.emplace(pose.frame, pose.T_map_object);
  }
  std::vector<Life> in_order;
  for (auto& [id, life] : lives) in_order.push_back(std::move(life));
  return in_order;
}

double distance_m(const SE3& a, const SE3& b) {
  return (a.translation() - b.translation()).norm();
}

// In which frames which objects are.
std::map<std::size_t, std::vector<Place>> present(const std::vector<Life>& lives) {
  std::map<std::size_t, std::vector<Place>> frames;
  for (Place i = 0; i < lives.size(); ++i) {
    for (const auto& [frame, pose] : lives[i].T_map_object) frames[frame].push_back(i);
  }
  return frames;
}

// Frames in which object (row) and track (column) are no farther apart than the gate.
Eigen::MatrixXd agreeing_frames(const std::vector<Life>& objects, const std::vector<Life>& tracks,
                                double gate_m) {
  Eigen::MatrixXd agreement = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(objects.size()),
                                                    static_cast<Eigen::Index>(tracks.size()));
  const auto tracks_in = present(tracks);
  for (Place i = 0; i < objects.size(); ++i) {
    for (const auto& [frame, pose] : objects[i].T_map_object) {
      const auto here = tracks_in.find(frame);
      if (here == tracks_in.end()) continue;
      for (const Place j : here->second) {
        if (distance_m(pose, tracks[j].T_map_object.at(frame)) > gate_m) continue;
        agreement(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) += 1.0;
      }
    }
  }
  return agreement;
}

// The track of each object for its whole life.
std::map<Place, Place> assign_lives(const Eigen::MatrixXd& agreement) {
  std::map<Place, Place> track_of;
  for (const auto& [row, col] : optimal_assignment(-agreement)) {
    if (agreement(row, col) > 0.0) track_of.emplace(static_cast<Place>(row), static_cast<Place>(col));
  }
  return track_of;
}

// Which track covers which object in one frame: the one of the frame before if it still does, then the
// nearest ones.
std::map<Place, Place> cover(const std::vector<Place>& object_ids, const std::vector<Place>& track_ids,
                             const std::vector<Life>& objects, const std::vector<Life>& tracks,
                             std::size_t frame, const std::map<Place, Place>& before, double gate_m) {
  Eigen::MatrixXd cost(static_cast<Eigen::Index>(object_ids.size()),
                       static_cast<Eigen::Index>(track_ids.size()));
  for (Place i = 0; i < object_ids.size(); ++i) {
    for (Place j = 0; j < track_ids.size(); ++j) {
      const double apart_m = distance_m(objects[object_ids[i]].T_map_object.at(frame),
                                        tracks[track_ids[j]].T_map_object.at(frame));
      const auto last = before.find(object_ids[i]);
      const bool same = last != before.end() && last->second == track_ids[j];
      const double cost_m = same ? apart_m - gate_m * 1e3 : apart_m;
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          apart_m <= gate_m ? cost_m : kForbidden;
    }
  }
  std::map<Place, Place> covered;
  for (const auto& [row, col] : optimal_assignment(cost)) {
    if (cost(row, col) >= kForbidden) continue;
    covered.emplace(object_ids[static_cast<Place>(row)], track_ids[static_cast<Place>(col)]);
  }
  return covered;
}

// Counts frame by frame: tracked, covered by another, missed, switched.
void count_frames(const std::vector<Life>& objects, const std::vector<Life>& tracks,
                  const std::map<Place, Place>& track_of, double gate_m, std::vector<ObjectErrors>& errors) {
  const auto tracks_in = present(tracks);
  std::map<Place, Place> last_track;
  std::map<Place, Place> before;
  for (const auto& [frame, here] : present(objects)) {
    const auto found = tracks_in.find(frame);
    const std::vector<Place> tracks_here = found == tracks_in.end() ? std::vector<Place>{} : found->second;
    before = cover(here, tracks_here, objects, tracks, frame, before, gate_m);
    for (const Place object : here) {
      ObjectErrors& error = errors[object];
      const auto covering = before.find(object);
      if (covering == before.end()) {
        ++error.missed_frames;
        continue;
      }
      const auto own = track_of.find(object);
      ++(own != track_of.end() && own->second == covering->second ? error.tracked_frames
                                                                  : error.other_frames);
      const auto [last, is_first] = last_track.emplace(object, covering->second);
      if (!is_first && last->second != covering->second) ++error.switches;
      last->second = covering->second;
    }
  }
}

struct RelativeErrors {
  double translation_sum = 0.0;  // per metre
  double rotation_sum_rad = 0.0;
  std::size_t count = 0;
};

// From each pair to the first one that the object has travelled far enough to reach.
RelativeErrors relative_errors(const std::vector<PosePair>& pairs, double subpath_m) {
  std::vector<double> travelled_m(pairs.size(), 0.0);
  for (Place i = 1; i < pairs.size(); ++i) {
    travelled_m[i] = travelled_m[i - 1] + distance_m(pairs[i - 1].T_world_truth, pairs[i].T_world_truth);
  }
  RelativeErrors sum;
  for (Place i = 0; i < pairs.size(); ++i) {
    const auto end = std::lower_bound(travelled_m.begin(), travelled_m.end(), travelled_m[i] + subpath_m);
    if (end == travelled_m.end()) break;
    const auto j = static_cast<Place>(end - travelled_m.begin());
    const SE3 truth = pairs[i].T_world_truth.inverse() * pairs[j].T_world_truth;
    const SE3 track = pairs[i].T_world_estimate.inverse() * pairs[j].T_world_estimate;
    const SE3 error = truth.inverse() * track;
    const double length_m = travelled_m[j] - travelled_m[i];
    sum.translation_sum += error.translation().norm() / length_m;
    sum.rotation_sum_rad += error.rotation_angle_rad() / length_m;
    ++sum.count;
  }
  return sum;
}

double root_mean_square(const std::vector<PosePair>& pairs, const SE3& T_truth_estimate) {
  double sum = 0.0;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d estimate = T_truth_estimate * pair.T_world_estimate.translation();
    sum += (pair.T_world_truth.translation() - estimate).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(pairs.size()));
}

void measure(const Life& object, const Life& track, double subpath_m, ObjectErrors& error) {
  std::vector<PosePair> pairs;
  for (const auto& [frame, pose] : object.T_map_object) {
    const auto found = track.T_map_object.find(frame);
    if (found == track.T_map_object.end()) continue;
    pairs.push_back({.frame = frame, .time_s = {}, .T_world_truth = pose, .T_world_estimate = found->second});
  }
  error.track_id = track.id;
  error.position_rmse_m = root_mean_square(pairs, SE3());
  error.ate_m = root_mean_square(pairs, align_positions(pairs));
  const RelativeErrors relative = relative_errors(pairs, subpath_m);
  if (relative.count == 0) return;
  const auto count = static_cast<double>(relative.count);
  error.rte_m_per_m = relative.translation_sum / count;
  error.rre_deg_per_m = relative.rotation_sum_rad * kDegPerRad / count;
}

double path_m(const Life& life) {
  double sum = 0.0;
  const SE3* last = nullptr;
  for (const auto& [frame, pose] : life.T_map_object) {
    if (last != nullptr) sum += distance_m(*last, pose);
    last = &pose;
  }
  return sum;
}

}  // namespace

ObjectEvaluation evaluate_objects(std::span<const ObjectPose> truth, std::span<const ObjectPose> tracks,
                                  const ObjectTrajectoryOptions& options) {
  const std::vector<Life> objects = lives_of(truth, options.min_points);
  const std::vector<Life> lives = lives_of(tracks, 0);
  const std::map<Place, Place> track_of =
      assign_lives(agreeing_frames(objects, lives, options.max_distance_m));

  ObjectEvaluation evaluation;
  for (const Life& object : objects) {
    ObjectErrors error;
    error.truth_id = object.id;
    error.type = object.type;
    error.truth_frames = object.T_map_object.size();
    error.truth_path_m = path_m(object);
    evaluation.objects.push_back(std::move(error));
  }
  count_frames(objects, lives, track_of, options.max_distance_m, evaluation.objects);
  std::set<Place> given;
  for (const auto& [object, track] : track_of) {
    given.insert(track);
    measure(objects[object], lives[track], options.subpath_m, evaluation.objects[object]);
  }
  for (Place i = 0; i < lives.size(); ++i) {
    if (!given.contains(i)) evaluation.tracks_without_object.push_back(lives[i].id);
  }
  return evaluation;
}

ObjectSummary summarise(std::span<const ObjectErrors> objects) {
  ObjectSummary summary;
  const auto mean = [&](std::optional<double> ObjectErrors::*measure) -> std::optional<double> {
    double sum = 0.0;
    std::size_t count = 0;
    for (const ObjectErrors& object : objects) {
      if (!(object.*measure)) continue;
      sum += *(object.*measure);
      ++count;
    }
    if (count == 0) return std::nullopt;
    return sum / static_cast<double>(count);
  };
  summary.objects = objects.size();
  for (const ObjectErrors& object : objects) {
    summary.lost += object.track_id ? 0 : 1;
    summary.switched += object.switches > 0 ? 1 : 0;
    summary.switches += object.switches;
    summary.truth_frames += object.truth_frames;
    summary.tracked_frames += object.tracked_frames;
    summary.other_frames += object.other_frames;
    summary.missed_frames += object.missed_frames;
  }
  summary.ate_m = mean(&ObjectErrors::ate_m);
  summary.position_rmse_m = mean(&ObjectErrors::position_rmse_m);
  summary.rte_m_per_m = mean(&ObjectErrors::rte_m_per_m);
  summary.rre_deg_per_m = mean(&ObjectErrors::rre_deg_per_m);
  return summary;
}

}  // namespace mlo
