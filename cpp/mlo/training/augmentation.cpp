#include "mlo/training/augmentation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace mlo {
namespace {

constexpr double kPi = std::numbers::pi;

/// The angle in [-pi, pi].
double wrapped(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * kPi);
}

std::vector<bool> within(const std::vector<Point>& points, const Box3d& box) {
  std::vector<bool> inside(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) inside[i] = is_within(points[i], box);
  return inside;
}

bool is_free(const Box3d& box, const std::vector<TrainingBox>& boxes, std::size_t without) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (i != without && collide(box, boxes[i].box)) return false;
  }
  return true;
}

/// Moves one object with its points to another box of the same size.
void move_object(TrainingExample& example, std::size_t index, const Box3d& target) {
  const Box3d source = example.boxes[index].box;
  const Eigen::Isometry3d T_target_source =
      Eigen::Translation3d(target.center_lidar_m) *
      Eigen::AngleAxisd(target.yaw_rad - source.yaw_rad, Eigen::Vector3d::UnitZ()) *
      Eigen::Translation3d(-source.center_lidar_m);
  const std::vector<bool> moves = within(example.points, source);
  const std::vector<bool> covered = within(example.points, target);
  std::vector<Point> points;
  points.reserve(example.points.size());
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (!moves[i] && covered[i]) continue;
    points.push_back(example.points[i]);
    if (moves[i])
      points.back().p_lidar = (T_target_source * points.back().p_lidar.cast<double>()).cast<float>();
  }
  example.points = std::move(points);
  example.boxes[index].box = target;
}

}  // namespace

TrainingExample flipped(TrainingExample example) {
  for (Point& point : example.points) point.p_lidar.y() = -point.p_lidar.y();
  for (TrainingBox& label : example.boxes) {
    label.box.center_lidar_m.y() = -label.box.center_lidar_m.y();
    label.box.yaw_rad = -label.box.yaw_rad;
  }
  return example;
}

TrainingExample rotated(TrainingExample example, double angle_rad) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (Point& point : example.points) point.p_lidar = (R * point.p_lidar.cast<double>()).cast<float>();
  for (TrainingBox& label : example.boxes) {
    label.box.center_lidar_m = R * label.box.center_lidar_m;
    label.box.yaw_rad = wrapped(label.box.yaw_rad + angle_rad);
  }
  return example;
}

TrainingExample scaled(TrainingExample example, double factor) {
  for (Point& point : example.points) point.p_lidar *= static_cast<float>(factor);
  for (TrainingBox& label : example.boxes) {
    label.box.center_lidar_m *= factor;
    label.box.size_lwh_m *= factor;
  }
  return example;
}

TrainingExample with_object_noise(TrainingExample example, const ObjectNoiseConfig& config, Random& random) {
  const double max_turn_rad = config.max_turn_deg * kPi / 180.0;
  for (std::size_t i = 0; i < example.boxes.size(); ++i) {
    Box3d target = example.boxes[i].box;
    // all are drawn, whether they are used or not: what happens to one object does not change the next
    const bool moves = random.chance(config.probability);
    target.center_lidar_m.x() += config.position_m * random.normal();
    target.center_lidar_m.y() += config.position_m * random.normal();
    target.yaw_rad = wrapped(target.yaw_rad + random.uniform(-max_turn_rad, max_turn_rad));
    if (!moves || !is_free(example.boxes[i].box, example.boxes, i) || !is_free(target, example.boxes, i)) {
      continue;
    }
    move_object(example, i, target);
  }
  return example;
}

TrainingExample augment(TrainingExample example, const ObjectBank& bank, const AugmentationConfig& config,
                        std::uint64_t seed) {
  const Random root(seed);
  Random for_objects = root.fork(0);
  Random for_noise = root.fork(1);
  Random for_whole = root.fork(2);
  example = place_objects(std::move(example), bank, config.sampling, for_objects);
  if (config.object_noise.probability > 0.0) {
    example = with_object_noise(std::move(example), config.object_noise, for_noise);
  }
  example.view.reset();
  const bool flip = for_whole.chance(config.flip_probability);
  const double angle_rad = for_whole.uniform(-1.0, 1.0) * config.max_rotation_deg * kPi / 180.0;
  const double factor = 1.0 + for_whole.uniform(-1.0, 1.0) * config.max_scaling;
  if (flip) example = flipped(std::move(example));
  if (config.max_rotation_deg > 0.0) example = rotated(std::move(example), angle_rad);
  if (config.max_scaling > 0.0) example = scaled(std::move(example), factor);
  return example;
}

}  // namespace mlo
