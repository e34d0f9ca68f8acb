#include "mlo/simulator/detection_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "mlo/core/log_odds.hpp"
#include "mlo/io/kitti_box.hpp"

namespace mlo::simulator {
namespace {

double horizontal_distance(const Box3d& box) {
  return box.center_lidar_m.head<2>().norm();
}

Box3d disturbed(const Box3d& truth, const DetectorErrors& errors, Random& random) {
  const double distance = horizontal_distance(truth);
  const double position = errors.position_m + errors.position_per_m * distance;
  Box3d box = truth;
  box.center_lidar_m += position * Eigen::Vector3d(random.normal(), random.normal(), 0.5 * random.normal());
  for (double& side : box.size_lwh_m) side *= std::max(0.2, 1.0 + errors.size_share * random.normal());
  box.yaw_rad += (errors.yaw_rad + errors.yaw_per_m * distance) * random.normal();
  if (random.chance(errors.flip_share)) box.yaw_rad += std::numbers::pi;
  box.yaw_rad = std::remainder(box.yaw_rad, 2.0 * std::numbers::pi);
  return box;
}

/// A car-sized box where none is.
Detection false_positive(const DetectorErrors& errors, Random& random) {
  constexpr double kGround_m = -1.73;
  const double distance = errors.max_range_m * std::sqrt(random.uniform(0.01, 1.0));
  const double azimuth = random.uniform(-std::numbers::pi, std::numbers::pi);
  Detection detection;
  detection.object_class = random.chance(0.7) ? ObjectClass::car : ObjectClass::pedestrian;
  const bool car = detection.object_class == ObjectClass::car;
  detection.box.size_lwh_m = car ? Eigen::Vector3d(4.2, 1.7, 1.5) : Eigen::Vector3d(0.7, 0.6, 1.75);
  detection.box.center_lidar_m = {distance * std::cos(azimuth), distance * std::sin(azimuth),
                                  kGround_m + 0.5 * detection.box.size_lwh_m.z()};
  detection.box.yaw_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
  detection.confidence = probability(-1.0 + errors.score_noise * random.normal());
  return detection;
}

/// More returns, more confidence.
double confidence(std::size_t points, const DetectorErrors& errors, Random& random) {
  if (errors.score_noise == 0.0) return 1.0;
  const double logit = 0.8 * std::log(std::max<double>(1.0, static_cast<double>(points)) / 8.0) + 1.0;
  return probability(logit + errors.score_noise * random.normal());
}

int count_of_false_positives(double mean, Random& random) {
  // Poisson (Knuth)
  const double limit = std::exp(-mean);
  int count = 0;
  for (double product = random.uniform(); product > limit; product *= random.uniform()) ++count;
  return count;
}

int ab3dmot_type(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::pedestrian:
      return 1;
    case ObjectClass::car:
    case ObjectClass::van:
      return 2;
    case ObjectClass::cyclist:
      return 3;
    default:
      return 0;
  }
}

}  // namespace

DetectorErrors DetectorErrors::none() {
  DetectorErrors errors;
  errors.position_m = errors.position_per_m = errors.size_share = errors.yaw_rad = errors.yaw_per_m = 0.0;
  errors.flip_share = errors.miss_share = errors.half_points = errors.false_positives = errors.score_noise =
      0.0;
  return errors;
}

std::vector<Detection> detect(const std::vector<ObjectTruth>& objects, const DetectorErrors& errors,
                              Random random) {
  std::vector<Detection> detections;
  for (const ObjectTruth& object : objects) {
    Random own = random.fork(static_cast<std::uint64_t>(object.id));
    const auto points = static_cast<double>(object.points);
    const bool in_reach = horizontal_distance(object.box_lidar) <= errors.max_range_m;
    if (!object.detectable || object.points < kMinLabelPoints || !in_reach) continue;
    // twice as many returns, much less risk: a logistic in the logarithm of their number
    const double p_seen = points * points / (points * points + errors.half_points * errors.half_points);
    if (!own.chance((1.0 - errors.miss_share) * p_seen)) continue;
    detections.push_back({object.object_class, disturbed(object.box_lidar, errors, own),
                          confidence(object.points, errors, own)});
  }
  Random others = random.fork(0);
  const int count = count_of_false_positives(errors.false_positives, others);
  for (int i = 0; i < count; ++i) detections.push_back(false_positive(errors, others));
  return detections;
}

std::string ab3dmot_lines(const Rig& rig, std::size_t frame, const std::vector<Detection>& detections) {
  constexpr double kSure = 1e-6;  // keeps the logit of certainty finite
  std::string lines;
  for (const Detection& detection : detections) {
    const int type = ab3dmot_type(detection.object_class);
    const std::optional<ImageView> view = project(rig, detection.box);
    if (type == 0 || !view) continue;
    const KittiBox box = box_in_camera(detection.box, rig.T_camera_lidar);
    const Eigen::Vector3d& size = detection.box.size_lwh_m;
    const double p = std::clamp(detection.confidence, kSure, 1.0 - kSure);
    lines += fmt::format(
        "{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},"
        "{:.4f}\n",
        frame, type, view->box.left_px, view->box.top_px, view->box.right_px, view->box.bottom_px,
        std::log(p / (1.0 - p)), size.z(), size.y(), size.x(), box.bottom_camera0_m.x(),
        box.bottom_camera0_m.y(), box.bottom_camera0_m.z(), box.rotation_y_rad, observation_angle_rad(box));
  }
  return lines;
}

}  // namespace mlo::simulator
