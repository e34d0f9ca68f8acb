#include "mlo/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mlo/core/heading.hpp"
#include "mlo/core/parallel.hpp"
#include "mlo/tracking/ego_from_boxes.hpp"
#include "mlo/tracking/visibility.hpp"

namespace mlo {
namespace {

/// A predicted object that may be farther off is not shown: where it is to be seen next is not known any
/// more.
constexpr double kMaxPredictedSd_m = 2.0;

double position_sd_m(const ObjectFilter& filter) {
  return std::sqrt(filter.planar_covariance().topLeftCorner<2, 2>().trace());
}

bool is_usable(const Detection& detection) {
  const Box3d& box = detection.box;
  return box.center_lidar_m.allFinite() && box.size_lwh_m.allFinite() &&
         (box.size_lwh_m.array() > 0.0).all() && std::isfinite(box.yaw_rad) &&
         std::isfinite(detection.confidence);
}

bool is_wheeled(ObjectClass object_class) {
  return object_class != ObjectClass::pedestrian && object_class != ObjectClass::other;
}

Box3d box_at(const SE3& T_map_object, const Eigen::Vector3d& size_lwh_m, const SE3& T_map_lidar) {
  return in_lidar({T_map_object.translation(), size_lwh_m, yaw_of(T_map_object)}, T_map_lidar);
}

double field_of_view_rad(const LifecycleConfig& config) {
  return config.field_of_view_deg * std::numbers::pi / 180.0;
}

}  // namespace

std::vector<Tracker::Observation> Tracker::observe(std::span<const Detection> detections,
                                                   const SE3& T_map_lidar) const {
  std::vector<Observation> observations;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    if (!is_usable(detections[i])) continue;
    observations.push_back({.measurement = measure(detections[i], T_map_lidar, config_.box_noise),
                            .object_class = detections[i].object_class,
                            .logit = confidence_logit(detections[i].confidence),
                            .range_m = detections[i].box.center_lidar_m.norm(),
                            .index = i});
  }
  return observations;
}

std::vector<TrackedObject> Tracker::process(std::span<const Detection> detections, const SE3& T_map_lidar,
                                            double dt_s) {
  T_map_lidar_ = T_map_lidar;
  for (Track& track : tracks_) track.filter.predict(dt_s, config_.motion);
  commit(observe(detections, T_map_lidar));
  return describe_all();
}

std::vector<TrackedObject> Tracker::process(std::span<const Detection> detections, double dt_s) {
  for (Track& track : tracks_) track.filter.predict(dt_s, config_.motion);
  const SE3 T_map_lidar = estimate_pose(detections);
  if (started_) last_increment_ = T_map_lidar_.inverse() * T_map_lidar;
  T_map_lidar_ = T_map_lidar;
  started_ = true;
  commit(observe(detections, T_map_lidar));
  return describe_all();
}

SE3 Tracker::estimate_pose(std::span<const Detection> detections) const {
  constexpr int kRounds = 2;  // the second associates with the pose that the first found
  const SE3 predicted = T_map_lidar_ * last_increment_;
  SE3 T_map_lidar = predicted;
  std::vector<AssociationTrack> tracks;
  for (const Track& track : tracks_) tracks.push_back({&track.filter, track.object_class});
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Observation> observations = observe(detections, T_map_lidar);
    std::vector<AssociationDetection> candidates;
    for (const Observation& o : observations) candidates.push_back({&o.measurement, o.object_class});
    AssociationConfig wide = config_.association;
    wide.gate *= 2.0;
    std::vector<BoxPair> pairs;
    for (const Assignment& pair : associate(tracks, candidates, wide)) {
      const ObjectFilter& filter = *tracks[static_cast<std::size_t>(pair.row)].filter;
      const Observation& o = observations[static_cast<std::size_t>(pair.col)];
      const double variance =
          0.5 * filter.planar_covariance().topLeftCorner<2, 2>().trace() +
          0.5 * (std::pow(o.measurement.along_sd_m, 2) + std::pow(o.measurement.across_sd_m, 2));
      pairs.push_back({.measured_lidar_m = detections[o.index].box.center_lidar_m.head<2>(),
                       .predicted_map_m = filter.box().center_map_m.head<2>(),
                       .sd_m = std::sqrt(variance)});
    }
    T_map_lidar = ego_from_boxes(pairs, predicted, {});
  }
  return T_map_lidar;
}

std::vector<TrackedObject> Tracker::process(std::span<const ObjectPoints> objects, const SE3& T_map_lidar,
                                            double dt_s, const SweepTiming& timing) {
  T_map_lidar_ = T_map_lidar;
  for (Track& track : tracks_) track.filter.predict(dt_s, config_.motion);
  std::vector<Detection> detections;
  for (const ObjectPoints& object : objects) detections.push_back(object.detection);
  commit(observe(detections, T_map_lidar));
  parallel_for_each_index(tracks_.size(), [&](std::size_t i) {
    if (tracks_[i].detection) update_odometry(tracks_[i], objects[*tracks_[i].detection], dt_s, timing);
  });
  return describe_all();
}

void Tracker::update_odometry(Track& track, const ObjectPoints& object, double dt_s,
                              const SweepTiming& timing) {
  track.num_points = object.points.size();
  const ObjectSighting sighting{.points = object.points,
                                .measurement = measure(object.detection, T_map_lidar_, config_.box_noise),
                                .confidence = std::clamp(object.detection.confidence, 0.0, 1.0),
                                .T_map_lidar = T_map_lidar_};
  if (!track.odometry) {
    track.odometry.emplace(sighting, timing, config_.sgf);
    return;
  }
  const PlacedBox box = track.filter.box();
  const ObjectPrior prior{.T_map_object = box.T_map_object(),
                          .size_lwh_m = box.size_lwh_m,
                          .moving_probability = track.filter.moving_probability(),
                          .scans_since = track.misses_before + 1};
  track.relative_motion = track.odometry->update(sighting, prior, timing, config_.sgf);
  if (track.relative_motion.usable() && dt_s > 0.0) {
    const double since_s = dt_s * prior.scans_since;
    const Eigen::Vector3d velocity_mps = track.odometry->moved_map_m() / since_s;
    const double variance = track.relative_motion.covariance.topLeftCorner<2, 2>().trace();
    track.filter.update_velocity(velocity_mps.head<2>(), std::sqrt(variance) / since_s, config_.motion);
  }
  const Eigen::Vector3d heading = track.odometry->T_map_object().rotation() * Eigen::Vector3d::UnitX();
  if (heading.head<2>().dot(Eigen::Vector2d(std::cos(box.yaw_rad), std::sin(box.yaw_rad))) < 0.0) {
    track.odometry->turn_round();
  }
}

void Tracker::commit(std::vector<Observation> observations) {
  for (Track& track : tracks_) {
    track.detection.reset();
    track.misses_before = track.misses;
    track.logit = 0.0;
    track.num_points = 0;
    track.relative_motion = {};
    ++track.age;
    ++track.misses;
  }
  learn_usual_width(observations);
  associate_and_update(observations, true);
  associate_and_update(observations, false);
  miss_unmatched();
  begin_tracks(std::move(observations));
  end_tracks();
}

std::vector<TrackedObject> Tracker::describe_all() const {
  std::vector<TrackedObject> objects;
  for (const Track& track : tracks_) objects.push_back(describe(track));
  return objects;
}

void Tracker::associate_and_update(std::vector<Observation>& observations, bool high_confidence) {
  std::vector<Track*> free_tracks;
  std::vector<AssociationTrack> rows;
  for (Track& track : tracks_) {
    if (track.detection) continue;
    free_tracks.push_back(&track);
    rows.push_back({&track.filter, track.object_class});
  }
  std::vector<Observation*> free_observations;
  std::vector<AssociationDetection> cols;
  for (Observation& o : observations) {
    if ((o.logit >= config_.association.high_confidence_logit) != high_confidence) continue;
    free_observations.push_back(&o);
    cols.push_back({&o.measurement, o.object_class});
  }
  for (const Assignment& pair : associate(rows, cols, config_.association)) {
    Track& track = *free_tracks[static_cast<std::size_t>(pair.row)];
    Observation& o = *free_observations[static_cast<std::size_t>(pair.col)];
    o.taken = true;
    track.filter.update(o.measurement, config_.motion);
    track.detection = o.index;
    track.misses = 0;
    ++track.hits;
    track.logit = o.logit;
    track.best_logit = std::max(track.best_logit, o.logit);
    track.existence += detection_evidence(o.logit, o.range_m, config_.lifecycle);
  }
}

void Tracker::learn_usual_width(std::span<const Observation> observations) {
  for (const Observation& o : observations) {
    const bool sure = o.logit >= config_.association.high_confidence_logit;
    if (sure && o.object_class == ObjectClass::car) usual_width_.add(o.measurement.box.size_lwh_m.y());
  }
}

void Tracker::judge(Track& track) const {
  const PlacedBox placed = track.filter.box();
  const Box3d box = in_lidar(placed, T_map_lidar_);
  const double margin_rad = field_of_view_margin_rad(box, field_of_view_rad(config_.lifecycle));
  const bool is_car = track.object_class == ObjectClass::car;
  track.belief = report_belief({.existence = track.existence,
                                .best_logit = track.best_logit,
                                .logit = track.logit,
                                .detectability = detectability(box.center_lidar_m.norm(), config_.lifecycle),
                                .margin_deg = margin_rad * 180.0 / std::numbers::pi,
                                .sd_m = track.detection ? 0.0 : position_sd_m(track.filter),
                                .wider_m = is_car ? usual_width_.excess_m(placed.size_lwh_m.y()) : 0.0},
                               weights_for(track.object_class, config_.report));
  track.state =
      next_state(track.state, {track.existence, track.belief >= 0.0, track.misses}, config_.lifecycle);
}

void Tracker::miss_unmatched() {
  std::vector<Box3d> boxes;
  for (const Track& track : tracks_) boxes.push_back(in_lidar(track.filter.box(), T_map_lidar_));
  const std::vector<double> hidden = hidden_shares(boxes);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Track& track = tracks_[i];
    if (!track.detection) {
      const bool in_view = field_of_view_margin_rad(boxes[i], field_of_view_rad(config_.lifecycle)) > 0.0;
      const double visible =
          (1.0 - hidden[i]) * detectability(boxes[i].center_lidar_m.norm(), config_.lifecycle);
      track.existence += miss_evidence(in_view ? visible : 0.0, config_.lifecycle);
    }
    track.existence = std::min(track.existence, config_.lifecycle.max_existence);
    judge(track);
  }
}

void Tracker::begin_tracks(std::vector<Observation> observations) {
  // The surest first: of several boxes around one object it is the one that begins a track.
  std::stable_sort(observations.begin(), observations.end(),
                   [](const Observation& a, const Observation& b) { return a.logit > b.logit; });
  for (const Observation& o : observations) {
    if (o.taken || o.logit < config_.lifecycle.min_birth_logit) continue;
    const bool duplicate = std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& track) {
      return track.detection &&
             footprint_overlap(track.filter.box(), o.measurement.box) > config_.lifecycle.max_overlap;
    });
    if (duplicate) continue;
    Track track{.id = next_id_++,
                .object_class = o.object_class,
                .filter = ObjectFilter(o.measurement, is_wheeled(o.object_class), config_.motion),
                .existence = detection_evidence(o.logit, o.range_m, config_.lifecycle),
                .best_logit = o.logit,
                .logit = o.logit,
                .detection = o.index};
    judge(track);
    tracks_.push_back(std::move(track));
  }
}

void Tracker::end_tracks() {
  const auto gives_way = [&](const Track& track) {
    return std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& other) {
      if (other.id == track.id || !other.detection || track.detection) return false;
      // A box of another kind is not this object under a new name: only the better believed one counts.
      const bool may_be_the_same = same_kind(track.object_class, other.object_class);
      if (!may_be_the_same && other.existence <= track.existence) return false;
      return footprint_overlap(track.filter.box(), other.filter.box()) > config_.lifecycle.max_overlap;
    });
  };
  for (Track& track : tracks_) {
    if (gives_way(track)) track.state = TrackState::dead;
  }
  std::erase_if(tracks_, [](const Track& track) { return track.state == TrackState::dead; });
}

TrackedObject Tracker::describe(const Track& track) const {
  const PlacedBox placed = track.filter.box();
  const bool is_placed = track.detection || position_sd_m(track.filter) <= kMaxPredictedSd_m;
  TrackedObject object{.id = track.id,
                       .object_class = track.object_class,
                       .state = track.state,
                       .reported = track.state != TrackState::tentative && track.belief >= 0.0 && is_placed,
                       .box = in_lidar(placed, T_map_lidar_),
                       .T_map_object = placed.T_map_object(),
                       .velocity_map_mps = track.filter.velocity_mps(),
                       .turn_rate_radps = track.filter.turn_rate_radps(),
                       .moving_probability = track.filter.moving_probability(),
                       .moving = track.filter.moving_probability() > 0.5,
                       .planar_covariance = track.filter.planar_covariance(),
                       .yaw_covariance = track.filter.yaw_covariance(),
                       .existence = track.existence,
                       .belief = track.belief,
                       .age = track.age,
                       .hits = track.hits,
                       .misses = track.misses,
                       .detection = track.detection,
                       .num_points = track.num_points,
                       .relative_motion = track.relative_motion};
  if (track.odometry && track.detection) {
    object.T_map_object = track.odometry->T_map_object();
    object.box = box_at(object.T_map_object, placed.size_lwh_m, T_map_lidar_);
  }
  return object;
}

}  // namespace mlo
