#include "mlo/pipeline/pipeline.hpp"

#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

#include "mlo/core/parallel.hpp"
#include "mlo/mapping/place_search.hpp"
#include "mlo/odometry/two_step_ego.hpp"
#include "mlo/perception/perceive.hpp"
#include "mlo/pipeline/find_objects.hpp"
#include "mlo/pipeline/prepare.hpp"

namespace mlo {
namespace {

// A gap longer than this many sweeps: the increment no longer describes the motion within one sweep.
constexpr double kGapSweeps = 1.5;
// Predictions over longer gaps than this many sweeps are no better than that.
constexpr double kMaxPredictedSweeps = 10.0;
// After so many scans in a row that are not found in the local maps, the maps are not of this place.
constexpr int kMaxScansLost = 3;

PerceptCounts count(const Scan& prepared, const Percept& seen) {
  PerceptCounts counts;
  counts.points = prepared.points.size();
  counts.ground_points = seen.num_ground_points;
  counts.ground_features = seen.ground.features.size();
  counts.edge_features = seen.edge.features.size();
  counts.surface_features = seen.surface.features.size();
  counts.candidates =
      seen.ground.candidates.size() + seen.edge.candidates.size() + seen.surface.candidates.size();
  counts.objects = seen.objects.size();
  for (const ObjectPoints& object : seen.objects) counts.object_points += object.points.size();
  counts.ambiguous_points = seen.num_ambiguous_points;
  return counts;
}

// Scan to scan, an increment is known less well than constant motion predicts it while nothing happens; it
// starts the refinement where it contradicts the prediction.
bool agrees(const SE3& T_odometry, const SE3& prediction, const MotionConfig& config) {
  const SE3 difference = prediction.inverse() * T_odometry;
  return difference.translation().norm() <= config.constant_motion_within_m &&
         difference.rotation_angle_rad() <= config.constant_motion_within_deg * std::numbers::pi / 180.0;
}

// Of the tracks that are believed, seen in this scan or not.
std::vector<Box3d> boxes_of_moving(std::span<const TrackedObject> objects) {
  std::vector<Box3d> boxes;
  for (const TrackedObject& object : objects) {
    if (object.reported && object.moving) boxes.push_back(object.box);
  }
  return boxes;
}

// Measured points brought to the reference time and placed by a pose.
template <class MeasuredPoint>
std::vector<Eigen::Vector3f> placed(const std::vector<MeasuredPoint>& points, const SweepMotion& motion,
                                    const SE3& T_map_lidar) {
  const Eigen::Matrix3d R_map_lidar = T_map_lidar.rotation().toRotationMatrix();
  std::vector<Eigen::Vector3f> points_map;
  points_map.reserve(points.size());
  for (const MeasuredPoint& point : points) {
    const Eigen::Vector3d p_lidar =
        motion.undistort(point.p_lidar.template cast<double>(), static_cast<double>(point.sweep_fraction));
    points_map.emplace_back((R_map_lidar * p_lidar + T_map_lidar.translation()).template cast<float>());
  }
  return points_map;
}

std::vector<FeaturePoint> thin(std::span<const FeaturePoint> points, double voxel_m) {
  return downsample_first<FeaturePoint>(points, static_cast<float>(voxel_m),
                                        [](const FeaturePoint& point) { return point.p_lidar; });
}

std::vector<FeaturePoint> to_features(std::span<const Point> points) {
  std::vector<FeaturePoint> features;
  features.reserve(points.size());
  for (const Point& point : points) {
    features.push_back({.p_lidar = point.p_lidar,
                        .sweep_fraction = point.sweep_fraction,
                        .intensity = point.intensity,
                        .ring = point.ring});
  }
  return features;
}

// Candidates above the ground, edges first, so that they are not thinned away.
std::vector<FeaturePoint> candidates_above_ground(const Percept& seen) {
  std::vector<FeaturePoint> above = seen.edge.candidates;
  above.insert(above.end(), seen.surface.candidates.begin(), seen.surface.candidates.end());
  return above;
}

}  // namespace

Pipeline::Pipeline(const PipelineConfig& config)
    : config_(config),
      network_(load_network(config.detection)),
      local_maps_{LocalMap(config.mapping.local_map), LocalMap(config.mapping.local_map),
                  LocalMap(config.mapping.local_map)},
      static_map_(config.mapping.static_map, config.mapping.free_space),
      unknown_movers_(config.mapping.unknown_movers, config.mapping.free_space),
      mover_trails_(config.mapping.static_map.trail_s),
      trajectories_(config.mapping.dynamic_check, config.mapping.refinement),
      tracker_(config.tracking) {}

Pipeline::Pipeline(const PipelineConfig& config, std::span<const MapPoint> map, const SE3& T_map_lidar_start)
    : Pipeline(config) {
  saved_map_ = SavedMap(map);
  state_.T_map_lidar = T_map_lidar_start;
}

FrameResult Pipeline::process(const Scan& scan, std::span<const Detection> detections) {
  return process_scan(scan, detections);
}

FrameResult Pipeline::process(const Scan& scan) {
  return process_scan(scan, std::nullopt);
}

FrameResult Pipeline::process_scan(const Scan& scan, std::optional<std::span<const Detection>> given) {
  FrameResult result;
  result.frame = scan.frame;
  result.stamp_s = scan.stamp_s;
  StageTimes& times = result.times;

  const Scan prepared =
      timed(times, Stage::prepare, [&] { return prepare(scan, config_.sensor, config_.input); });
  const GroundSegmentation ground = timed(
      times, Stage::perception, [&] { return segment_ground(prepared.points, config_.perception.ground); });
  FoundObjects found;
  if (!given) found = timed(times, Stage::detection, [&] { return find_objects(prepared, ground); });
  Percept seen = timed(times, Stage::perception, [&] {
    return perceive(prepared, ground, given.value_or(found.objects), config_.perception);
  });
  result.counts = count(prepared, seen);

  const SweepTiming sweep = timing(prepared);
  const SE3 prediction = predict(sweep);
  const EgoOdometryResult ego = timed(
      times, Stage::odometry, [&] { return estimate_increment(seen, prediction, sweep, prepared.frame); });
  const SE3 T_odometry = ego.increment.usable() ? ego.increment.T_target_source : prediction;
  const SE3 T_start = agrees(T_odometry, prediction, config_.motion) ? prediction : T_odometry;
  result.first = state_.empty && saved_map_.empty();
  result.odometry = ego.increment;
  result.consistency = ego.consistency;
  const bool motion_known = state_.motion_known || ego.increment.usable();
  result.refinement =
      timed(times, Stage::refinement, [&] { return refine_pose(seen, T_start, motion_known, sweep); });

  const SE3 T_map_lidar =
      result.refinement.usable() ? result.refinement.T_target_source : state_.T_map_lidar * T_odometry;
  const SE3 increment = sweep_increment(T_odometry, T_map_lidar);
  const SweepMotion motion = SweepMotion::from_increment(increment, sweep);
  timed(times, Stage::tracking, [&] {
    if (!state_.placed && !result.localised()) return;
    result.objects = track(prepared, seen, T_map_lidar, sweep);
    find_moving(seen, motion, T_map_lidar, result.objects);
    result.finished_objects = trajectories_.take_finished();
  });
  State next;
  next.frame = prepared.frame;
  next.stamp_s = prepared.stamp_s;
  next.T_odom_lidar = state_.T_odom_lidar * T_odometry;
  next.T_map_lidar = T_map_lidar;
  next.T_sweep = interpolate(increment, 1.0 / sweep.sweeps_since_previous);
  next.likely_objects = std::move(found.likely);
  timed(times, Stage::map_update, [&] { commit(prepared, seen, motion, std::move(next), result); });
  result.percept = std::move(seen);
  return result;
}

FoundObjects Pipeline::find_objects(const Scan& prepared, const GroundSegmentation& ground) const {
  std::optional<FoundBefore> before;
  if (!state_.empty) before = {state_.likely_objects, predict(timing(prepared)).inverse()};
  return detect(prepared.points, ground.is_ground, before, config_.detection, network_.get());
}

SweepTiming Pipeline::timing(const Scan& scan) const {
  SweepTiming timing{scan.motion_compensated, config_.motion.reference_fraction};
  if (state_.empty || scan.duration_s <= 0.0) return timing;
  const double sweeps = (scan.stamp_s - state_.stamp_s) / scan.duration_s;
  if (sweeps >= kGapSweeps) timing.sweeps_since_previous = sweeps;
  return timing;
}

SE3 Pipeline::predict(const SweepTiming& timing) const {
  return interpolate(state_.T_sweep, std::min(timing.sweeps_since_previous, kMaxPredictedSweeps));
}

PredictedPoses Pipeline::predict_poses(double sweeps_ahead) const {
  const SE3 motion = interpolate(state_.T_sweep, std::min(sweeps_ahead, kMaxPredictedSweeps));
  return {state_.T_odom_lidar * motion, state_.T_map_lidar * motion};
}

EgoOdometryResult Pipeline::estimate_increment(const Percept& seen, const SE3& prediction,
                                               const SweepTiming& timing, std::size_t frame) const {
  if (state_.empty || !config_.odometry.enabled) return {};
  const std::optional<SE3> guess = state_.motion_known ? std::optional(prediction) : std::nullopt;
  return estimate_ego(seen, state_.reference, guess, timing, config_.odometry, frame);
}

std::vector<TrackedObject> Pipeline::track(const Scan& scan, const Percept& seen, const SE3& T_map_lidar,
                                           const SweepTiming& timing) {
  const double dt_s = state_.empty ? 0.0 : std::max(0.0, scan.stamp_s - state_.stamp_s);
  return tracker_.process(seen.objects, T_map_lidar, dt_s, timing);
}

// Detections where objects rested in earlier scans, with the maps of these.
std::vector<Pipeline::ObjectAtRest> Pipeline::find_objects_at_rest(const Percept& seen,
                                                                   const SE3& T_previous_current) const {
  std::vector<ObjectAtRest> at_rest;
  if (!config_.mapping.dynamic_check.static_objects_localise) return at_rest;
  const SE3 T_map_lidar = state_.T_map_lidar * T_previous_current;
  for (const ObjectPoints& object : seen.objects) {
    const LocalMap* map = trajectories_.map_at_rest(T_map_lidar * object.detection.box.center_lidar_m);
    if (map == nullptr) continue;
    at_rest.push_back({thin(to_features(object.points), config_.mapping.refinement.source_voxel_m), map});
  }
  return at_rest;
}

PoseEstimate Pipeline::refine_pose(const Percept& seen, const SE3& T_previous_current, bool motion_known,
                                   const SweepTiming& timing) {
  PoseEstimate refined;
  if (state_.empty && saved_map_.empty()) return refined;
  const RefinementConfig& config = config_.mapping.refinement;
  const bool separate = config_.mapping.local_map.separate_classes;
  std::vector<FeaturePoint> ground;
  std::vector<FeaturePoint> edges;
  std::vector<FeaturePoint> rest;
  parallel_invoke([&] { ground = thin(seen.ground.candidates, config.source_voxel_m); },
                  [&] {
                    if (separate) edges = thin(seen.edge.candidates, config.source_voxel_m);
                    rest = thin(separate ? seen.surface.candidates : candidates_above_ground(seen),
                                config.source_voxel_m);
                  });
  std::vector<RefinementTerm> terms{
      {ground, separate ? &local_maps_.ground : &local_maps_.surface, ExpectedShape::plane},
      {edges, &local_maps_.edge, ExpectedShape::line},
      {rest, &local_maps_.surface, ExpectedShape::plane}};
  const std::vector<ObjectAtRest> at_rest = find_objects_at_rest(seen, T_previous_current);
  for (const ObjectAtRest& object : at_rest) {
    terms.push_back({object.points, object.map, ExpectedShape::plane});
  }
  RefinementGuess guess{state_.T_map_lidar, T_previous_current, motion_known, timing};
  if (!saved_map_.empty()) return refine_in_saved_map(terms, guess);
  refined = refine(terms, guess, config);

  if (state_.unplaced && refined.usable()) {
    // Only now is the motion known that distorted the first scan: put it into the map again, and repeat.
    if (config.correct_distortion) {
      guess.T_previous_current = state_.T_map_lidar.inverse() * refined.T_target_source;
    }
    guess.motion_known = true;
    clear_maps();
    const SweepMotion motion = SweepMotion::from_increment(guess.T_previous_current, timing);
    const PlacedCandidates in_map = place(*state_.unplaced, motion, state_.T_map_lidar);
    static_map_.insert(insert_in_local_maps(*state_.unplaced, in_map, state_.T_map_lidar), state_.frame);
    refined = refine(terms, guess, config);
  }
  return refined;
}

PoseEstimate Pipeline::refine_in_saved_map(std::span<const RefinementTerm> terms,
                                           const RefinementGuess& guess) {
  const SE3 T_map_lidar = guess.T_map_lidar_previous * guess.T_previous_current;
  insert_saved_map_near(T_map_lidar.translation().cast<float>());
  if (state_.placed) return refine(terms, guess, config_.mapping.refinement);
  return find_place(terms, T_map_lidar, config_.mapping.place_search, config_.mapping.refinement);
}

// Nothing is forgotten: there is no more of it than of the saved map.
void Pipeline::insert_saved_map_near(const Eigen::Vector3f& center_map) {
  const bool separate = config_.mapping.local_map.separate_classes;
  const auto radius_m = static_cast<float>(config_.mapping.local_map.radius_m);
  for (const MapPoint& point : saved_map_.take_near(center_map, radius_m)) {
    LocalMap* map = &local_maps_.surface;
    if (separate && point.label == MapLabel::ground) map = &local_maps_.ground;
    if (separate && point.label == MapLabel::edge) map = &local_maps_.edge;
    map->insert({&point.p_map, 1});
  }
}

void Pipeline::clear_local_maps() {
  for (LocalMap* map : {&local_maps_.ground, &local_maps_.edge, &local_maps_.surface}) map->clear();
}

bool Pipeline::local_maps_are_empty() const {
  return local_maps_.ground.empty() && local_maps_.edge.empty() && local_maps_.surface.empty();
}

void Pipeline::clear_maps() {
  clear_local_maps();
  static_map_ = StaticMap(config_.mapping.static_map, config_.mapping.free_space);
  unknown_movers_ = UnknownMovers(config_.mapping.unknown_movers, config_.mapping.free_space);
  mover_trails_ = MoverTrails(config_.mapping.static_map.trail_s);
}

Pipeline::PlacedCandidates Pipeline::place(const Percept& seen, const SweepMotion& motion,
                                           const SE3& T_map_lidar) {
  PlacedCandidates in_map;
  parallel_invoke([&] { in_map.ground = placed(seen.ground.candidates, motion, T_map_lidar); },
                  [&] {
                    in_map.edge = placed(seen.edge.candidates, motion, T_map_lidar);
                    in_map.surface = placed(seen.surface.candidates, motion, T_map_lidar);
                  });
  return in_map;
}

// Returns the candidates that the static map may not have yet: those at places that the local maps did not
// have, and some of the others in turn.
std::vector<MapPoint> Pipeline::insert_in_local_maps(const Percept& seen, const PlacedCandidates& in_map,
                                                     const SE3& T_map_lidar) {
  const bool separate = config_.mapping.local_map.separate_classes;
  const auto turns = static_cast<std::size_t>(config_.mapping.static_map.turns);
  LocalMaps& maps = local_maps_;
  std::vector<MapPoint> unmapped;
  const auto insert = [&](const std::vector<Eigen::Vector3f>& points_map, const FeatureSet& set,
                          LocalMap& own_map, MapLabel label) {
    const std::vector<std::uint8_t> added = (separate ? own_map : maps.surface).insert(points_map);
    for (std::size_t i = 0; i < added.size(); ++i) {
      if (added[i] == 0 && (i + state_.frame) % turns != 0) continue;
      unmapped.push_back({points_map[i], set.candidates[i].intensity, label});
    }
  };
  insert(in_map.edge, seen.edge, maps.edge, MapLabel::edge);
  insert(in_map.ground, seen.ground, maps.ground, MapLabel::ground);
  insert(in_map.surface, seen.surface, maps.surface, MapLabel::surface);
  for (LocalMap* map : {&maps.ground, &maps.edge, &maps.surface}) {
    map->forget_beyond_radius(T_map_lidar.translation().cast<float>());
  }
  return unmapped;
}

FoundMovers Pipeline::find_unknown_movers(double stamp_s, const PlacedCandidates& in_map) {
  if (config_.mapping.unknown_movers.every == 0) return {};
  std::vector<Eigen::Vector3f> above_ground = in_map.edge;
  above_ground.insert(above_ground.end(), in_map.surface.begin(), in_map.surface.end());
  return unknown_movers_.update(stamp_s, above_ground);
}

// Takes back what movers left in the static map before they were known to move.
// @return where those that were lost should be, lidar frame
std::vector<Box3d> Pipeline::follow_trails(const Scan& scan, const SE3& T_map_lidar,
                                           std::span<const TrackedObject> objects,
                                           std::span<const UnknownMover> unknown_movers) {
  std::vector<TrailedObject> trailed;
  for (const TrackedObject& object : objects) {
    trailed.push_back({.id = object.id,
                       .T_map_object = object.T_map_object,
                       .size_lwh_m = object.box.size_lwh_m,
                       .velocity_map_mps = object.velocity_map_mps,
                       .moves = object.reported && object.moving});
  }
  for (const UnknownMover& mover : unknown_movers) {
    trailed.push_back({.id = -mover.id,  // those of tracks are positive
                       .T_map_object = mover.T_map_way,
                       .size_lwh_m = mover.way_lwh_m,
                       .velocity_map_mps = mover.velocity_map_mps,
                       .moves = true});
  }
  const Trails trails = mover_trails_.update(scan.frame, scan.stamp_s, trailed);
  for (const TrailPlace& place : trails.before) {
    static_map_.take_back(place.frame, place.T_map_object, place.size_lwh_m);
  }
  std::vector<Box3d> lost;
  for (const TrailPlace& place : trails.now) {
    lost.push_back(upright_box(T_map_lidar.inverse() * place.T_map_object, place.size_lwh_m));
  }
  return lost;
}

void Pipeline::update_static_map(const Scan& scan, std::span<const MapPoint> unmapped,
                                 const SweepMotion& motion, const SE3& T_map_lidar,
                                 std::span<const TrackedObject> objects, const FoundMovers& unknown) {
  LeftOut left_out{T_map_lidar, boxes_of_moving(objects), unknown.columns};
  for (const UnknownMover& mover : unknown.movers) {
    left_out.moving.push_back(upright_box(T_map_lidar.inverse() * mover.T_map_way, mover.way_lwh_m));
  }
  const std::vector<Box3d> lost = follow_trails(scan, T_map_lidar, objects, unknown.movers);
  left_out.moving.insert(left_out.moving.end(), lost.begin(), lost.end());
  static_map_.insert(unmapped, scan.frame, left_out);
  const auto is_turn = [&](int every) {
    return every > 0 && scan.frame % static_cast<std::size_t>(every) == 0;
  };
  const bool votes = is_turn(config_.mapping.free_space.every);
  const bool is_remembered = is_turn(config_.mapping.unknown_movers.every);
  if (votes || is_remembered) {
    ScanView view(scan.points, motion, T_map_lidar);
    if (votes) static_map_.observe(view);
    if (is_remembered) unknown_movers_.remember(std::move(view));
  }
  static_map_.spool_far(T_map_lidar.translation().cast<float>());
}

// The motion since the previous scan that removes distortion from what is put into maps. The first pose that
// is found in a saved map says nothing of it: the one before was a guess.
SE3 Pipeline::sweep_increment(const SE3& T_odometry, const SE3& T_map_lidar) const {
  const bool follow_map = config_.mapping.refinement.correct_distortion;
  return follow_map && state_.placed ? state_.T_map_lidar.inverse() * T_map_lidar : T_odometry;
}

void Pipeline::find_moving(const Percept& seen, const SweepMotion& motion, const SE3& T_map_lidar,
                           std::vector<TrackedObject>& objects) {
  std::vector<ObjectSight> sights;
  for (const TrackedObject& object : objects) {
    ObjectSight sight{.id = object.id,
                      .T_map_object = object.T_map_object,
                      .moving_probability = object.moving_probability};
    if (object.detection) {
      sight.points_map = placed(seen.objects[*object.detection].points, motion, T_map_lidar);
    }
    sights.push_back(std::move(sight));
  }
  const std::vector<Mobility> mobilities = trajectories_.update(sights);
  for (std::size_t i = 0; i < objects.size(); ++i) objects[i].moving = mobilities[i] == Mobility::moving;
}

std::vector<MappedObject> Pipeline::object_maps() const {
  return trajectories_.maps();
}

void Pipeline::commit(const Scan& scan, const Percept& seen, const SweepMotion& motion, State next,
                      FrameResult& result) {
  const SE3& T_map_lidar = next.T_map_lidar;
  next.empty = false;
  next.motion_known = result.refinement.usable() && state_.placed;
  if (result.first && !scan.motion_compensated) next.unplaced = seen;
  const bool placeable =
      result.counts.candidates >= static_cast<std::size_t>(config_.mapping.refinement.min_matches);
  if (!result.localised()) next.scans_lost = state_.scans_lost + (placeable ? 1 : 0);
  const bool makes_map = saved_map_.empty();
  next.placed = makes_map || result.localised() || (state_.placed && next.scans_lost < kMaxScansLost);
  const bool new_local_maps = makes_map && placeable && !result.localised() &&
                              (local_maps_are_empty() || next.scans_lost >= kMaxScansLost);
  if (new_local_maps) {
    clear_local_maps();
    next.scans_lost = 0;
  }
  const bool grows_static_map = makes_map && result.localised();
  const PlacedCandidates in_map =
      grows_static_map || new_local_maps ? place(seen, motion, T_map_lidar) : PlacedCandidates{};
  std::vector<MapPoint> unmapped;
  FoundMovers unknown;
  parallel_invoke(
      [&] {
        if (config_.odometry.enabled)
          next.reference =
              make_reference_scan(seen, motion, static_cast<std::size_t>(config_.odometry.max_candidates));
        if (grows_static_map) unknown = find_unknown_movers(scan.stamp_s, in_map);
      },
      [&] {
        if (grows_static_map || new_local_maps) unmapped = insert_in_local_maps(seen, in_map, T_map_lidar);
      });
  if (grows_static_map) {
    update_static_map(scan, unmapped, motion, T_map_lidar, result.objects, unknown);
    result.unknown_movers = std::move(unknown.movers);
  }

  result.motion = motion;
  result.T_reference_stamp = motion.T_reference_at(scan.stamp_fraction);
  result.T_odom_lidar = next.T_odom_lidar * result.T_reference_stamp;
  result.T_map_lidar = next.T_map_lidar * result.T_reference_stamp;
  state_ = std::move(next);
}

}  // namespace mlo
