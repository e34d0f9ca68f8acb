#include "mlo/tracking/object_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mlo/core/heading.hpp"
#include "mlo/tracking/sgf_solver.hpp"

namespace mlo {
namespace {

/// The angle, turned round if it points away from the reference.
double same_way(double yaw_rad, double reference_rad) {
  const bool flipped = std::abs(wrapped_angle(yaw_rad - reference_rad)) > 0.5 * std::numbers::pi;
  return wrapped_angle(flipped ? yaw_rad + std::numbers::pi : yaw_rad);
}

ShapedPoint moved(const ShapedPoint& point, const SE3& T) {
  const Eigen::Matrix3d R = T.rotation().toRotationMatrix();
  return {.p_lidar = T * point.p_lidar, .share = 1.0, .covariance = R * point.covariance * R.transpose()};
}

}  // namespace

SE3 absolute_motion(const SE3& delta, const SE3& H) {
  return delta * H.inverse();
}

SE3 body_fixed_motion(const SE3& L_lidar_object, const SE3& X) {
  return L_lidar_object.inverse() * X * L_lidar_object;
}

ObjectOdometry::ObjectOdometry(const ObjectSighting& first, const SweepTiming& timing,
                               const SgfConfig& config)
    : T_map_object_(first.measurement.box.T_map_object()),
      T_map_lidar_(first.T_map_lidar),
      last_box_lidar_(in_lidar(first.measurement.box, first.T_map_lidar)) {
  // The object's motion within its first sweep is not known yet.
  remember(shape(first, 1, timing), SE3(), T_map_lidar_.inverse() * T_map_object_, config);
}

std::vector<ShapedPoint> ObjectOdometry::shape(const ObjectSighting& sighting, int scans_since,
                                               const SweepTiming& timing) const {
  std::vector<Eigen::Vector3d> positions;
  for (const Point& point : sighting.points) positions.push_back(point.p_lidar.cast<double>());
  std::vector<ShapedPoint> shaped = shaped_points(positions, {});
  if (timing.motion_compensated || shaped.empty()) return shaped;
  // Thinning keeps points as they are and in order: walk along to find the time of each.
  std::size_t next = 0;
  for (ShapedPoint& point : shaped) {
    while (positions[next] != point.p_lidar) ++next;
    const double fraction = static_cast<double>(sighting.points[next].sweep_fraction);
    point.share = 1.0 + (fraction - timing.reference_fraction) / (timing.sweeps_since_previous * scans_since);
  }
  return shaped;
}

void ObjectOdometry::remember(std::vector<ShapedPoint> points, const SE3& H, const SE3& L_lidar_object,
                              const SgfConfig& config) {
  for (ShapedPoint& point : points) {
    const SE3 T_reference_at = interpolate(H, point.share - 1.0);
    point = moved(point, L_lidar_object.inverse() * T_reference_at);
  }
  if (!points.empty()) points_object_.push_back(std::move(points));
  while (points_object_.size() > static_cast<std::size_t>(config.target_scans)) points_object_.pop_front();
}

ObjectTarget ObjectOdometry::target(const SE3& L_lidar_object, const SgfConfig& config) const {
  std::vector<ShapedPoint> points;
  for (const std::vector<ShapedPoint>& scan : points_object_) {
    for (const ShapedPoint& point : scan) points.push_back(moved(point, L_lidar_object));
  }
  return {points, config.voxel_m};
}

PoseEstimate ObjectOdometry::update(const ObjectSighting& sighting, const ObjectPrior& prior,
                                    const SweepTiming& timing, const SgfConfig& config) {
  const SE3 L_previous = T_map_lidar_.inverse() * T_map_object_;
  const double guess_yaw = same_way(yaw_of(prior.T_map_object), yaw_of(T_map_object_));
  const SE3 T_map_object_ahead(
      so3_exp({0.0, 0.0, guess_yaw - yaw_of(T_map_object_)}) * T_map_object_.rotation(),
      prior.T_map_object.translation());
  const SE3 L_guess = sighting.T_map_lidar.inverse() * T_map_object_ahead;
  const SE3 H_guess = L_previous * L_guess.inverse();

  Box3d now = in_lidar(sighting.measurement.box, sighting.T_map_lidar);
  now.yaw_rad = same_way(now.yaw_rad, yaw_of(L_guess));
  Box3d before{L_previous.translation(), prior.size_lwh_m, yaw_of(L_previous)};
  if (config.printed_weights) before = last_box_lidar_;
  const std::vector<ShapedPoint> points = shape(sighting, prior.scans_since, timing);
  const ObjectTarget previous_points = target(L_previous, config);
  const BoxMeasurement& noise = sighting.measurement;
  const SgfProblem problem{.target = &previous_points,
                           .points = points,
                           .previous_box = before,
                           .current_box = now,
                           .confidence = sighting.confidence,
                           .center_sd_m = {noise.along_sd_m, noise.across_sd_m, noise.height_sd_m},
                           .yaw_sd_rad = noise.yaw_sd_rad};
  PoseEstimate estimate = estimate_relative_motion(problem, H_guess, config);
  const SE3 H = estimate.usable() ? estimate.T_target_source : H_guess;

  const SE3 delta = T_map_lidar_.inverse() * sighting.T_map_lidar;
  move_on(body_fixed_motion(L_previous, absolute_motion(delta, H)), prior.moving_probability, config);
  T_map_lidar_ = sighting.T_map_lidar;
  last_box_lidar_ = now;
  remember(points, H, T_map_lidar_.inverse() * T_map_object_, config);
  return estimate;
}

void ObjectOdometry::move_on(const SE3& body_fixed, double moving_probability, const SgfConfig& config) {
  moved_map_m_ = T_map_object_.rotation() * body_fixed.translation();
  // As long as it may as well move as stand, all of it counts.
  const double stands = std::max(0.0, 1.0 - 2.0 * moving_probability);
  const double counts = 1.0 - stands * (1.0 - config.standing_gain);
  T_map_object_ = T_map_object_ * interpolate(body_fixed, counts);
}

void ObjectOdometry::turn_round() {
  const SE3 half_turn(so3_exp({0.0, 0.0, std::numbers::pi}), Eigen::Vector3d::Zero());
  T_map_object_ = T_map_object_ * half_turn;
  last_box_lidar_.yaw_rad = wrapped_angle(last_box_lidar_.yaw_rad + std::numbers::pi);
  for (std::vector<ShapedPoint>& scan : points_object_) {
    for (ShapedPoint& point : scan) point = moved(point, half_turn.inverse());
  }
}

}  // namespace mlo
