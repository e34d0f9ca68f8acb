#include "mlo/training/object_bank.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "mlo/core/box_overlap.hpp"
#include "mlo/core/point_budget.hpp"

namespace mlo {
namespace {

constexpr std::array kPlaced{ObjectClass::car, ObjectClass::van, ObjectClass::truck, ObjectClass::pedestrian,
                             ObjectClass::cyclist};
constexpr int kTriesPerObject = 4;
// The ground beside an object is the lowest part of what lies around it, without stray points below.
constexpr double kGroundMargin_m = 1.0;
constexpr std::size_t kMinGroundPoints = 5;
constexpr double kGroundShare = 0.1;

bool stands_alone(const std::vector<TrainingBox>& boxes, std::size_t index) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (i != index && collide(boxes[index].box, boxes[i].box)) return false;
  }
  return true;
}

/// Its points are counted anew: an example's points may have been thinned since its boxes were made.
BankedObject cut_out(const TrainingExample& example, const TrainingBox& label) {
  BankedObject object{label, {}};
  std::ranges::copy_if(example.points, std::back_inserter(object.points),
                       [&](const Point& point) { return is_within(point, label.box); });
  return object;
}

/// Height of the ground around a box; nothing where too little is seen there.
std::optional<double> ground_around(std::span<const Point> points, const Box3d& box) {
  const double reach_m = 0.5 * box.size_lwh_m.head<2>().norm() + kGroundMargin_m;
  std::vector<float> heights;
  for (const Point& point : points) {
    const Eigen::Vector2d apart = point.p_lidar.head<2>().cast<double>() - box.center_lidar_m.head<2>();
    if (apart.squaredNorm() < reach_m * reach_m) heights.push_back(point.p_lidar.z());
  }
  if (heights.size() < kMinGroundPoints) return std::nullopt;
  const auto rank = static_cast<std::ptrdiff_t>(kGroundShare * static_cast<double>(heights.size()));
  std::ranges::nth_element(heights, heights.begin() + rank);
  return heights[static_cast<std::size_t>(rank)];
}

/// How far an object is raised to stand on the ground; nothing if that would be too much.
std::optional<double> lift_to_ground(std::span<const Point> points, const Box3d& box, double max_lift_m) {
  if (max_lift_m == 0.0) return 0.0;
  const double bottom_m = box.center_lidar_m.z() - 0.5 * box.size_lwh_m.z();
  const double lift_m = ground_around(points, box).value_or(bottom_m) - bottom_m;
  if (std::abs(lift_m) > max_lift_m) return std::nullopt;
  return lift_m;
}

/// The object where it may stand in the example; nothing if it may not.
std::optional<BankedObject> fitted(const BankedObject& object, const TrainingExample& example,
                                   const SamplingConfig& config) {
  const Box3d& box = object.label.box;
  if (example.view && !shows(*example.view, box.center_lidar_m)) return std::nullopt;
  for (const TrainingBox& other : example.boxes) {
    if (collide(box, other.box, config.clearance_m)) return std::nullopt;
  }
  const auto lift_m = lift_to_ground(example.points, box, config.max_lift_m);
  if (!lift_m) return std::nullopt;
  BankedObject moved = object;
  moved.label.box.center_lidar_m.z() += *lift_m;
  for (Point& point : moved.points) point.p_lidar.z() += static_cast<float>(*lift_m);
  return moved;
}

void put_into(TrainingExample& example, BankedObject object) {
  std::erase_if(example.points, [&](const Point& point) { return is_within(point, object.label.box); });
  example.points.insert(example.points.end(), object.points.begin(), object.points.end());
  object.label.points = count_within(object.points, object.label.box);
  example.boxes.push_back(std::move(object.label));
}

}  // namespace

bool collide(const Box3d& a, const Box3d& b, double margin_m) {
  Box3d grown = a;
  grown.size_lwh_m.head<2>().array() += 2.0 * margin_m;
  return footprint_iou(grown, b) > 0.0;
}

void ObjectBank::add(const TrainingExample& example) {
  for (std::size_t i = 0; i < example.boxes.size(); ++i) {
    if (!example.boxes[i].demanded || !stands_alone(example.boxes, i)) continue;
    BankedObject object = cut_out(example, example.boxes[i]);
    if (object.points.size() < limits_.min_points) continue;
    Shelf& shelf = shelves_[object.label.object_class];
    // Reservoir sampling: of all that were offered so far, each is kept with the same probability.
    std::size_t place = shelf.offered++;
    if (place >= limits_.objects) place = random_.bits() % shelf.offered;
    if (place >= limits_.objects) continue;
    object.points = thin_points(object.points, limits_.points);
    if (place == shelf.objects.size()) {
      shelf.objects.push_back(std::move(object));
    } else {
      shelf.objects[place] = std::move(object);
    }
  }
}

std::span<const BankedObject> ObjectBank::objects(ObjectClass object_class) const {
  const auto found = shelves_.find(object_class);
  if (found == shelves_.end()) return {};
  return found->second.objects;
}

TrainingExample place_objects(TrainingExample example, const ObjectBank& bank, const SamplingConfig& config,
                              Random& random) {
  for (const ObjectClass object_class : kPlaced) {
    const std::span<const BankedObject> objects = bank.objects(object_class);
    if (objects.empty()) continue;
    const auto present = std::ranges::count_if(example.boxes, [&](const TrainingBox& label) {
      return label.demanded && label.object_class == object_class;
    });
    int missing = config.wanted(object_class) - static_cast<int>(present);
    for (int tries = kTriesPerObject * missing; missing > 0 && tries > 0; --tries) {
      auto object = fitted(objects[random.bits() % objects.size()], example, config);
      if (!object) continue;
      put_into(example, std::move(*object));
      --missing;
    }
  }
  return example;
}

}  // namespace mlo
