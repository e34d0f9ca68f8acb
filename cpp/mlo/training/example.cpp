#include "mlo/training/example.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mlo {
namespace {

bool is_usable(const Box3d& box) {
  return box.center_lidar_m.allFinite() && box.size_lwh_m.allFinite() && std::isfinite(box.yaw_rad) &&
         (box.size_lwh_m.array() > 0.0).all();
}

}  // namespace

bool shows(const LabelledView& view, const Eigen::Vector3d& p_lidar) {
  const Eigen::Vector3d p_camera0 = view.T_camera0_lidar * p_lidar;
  const Eigen::Vector3d pixel = view.P2 * p_camera0.homogeneous();
  if (!(p_camera0.z() > 0.0 && pixel.z() > 0.0)) return false;
  const double u_px = pixel.x() / pixel.z();
  const double v_px = pixel.y() / pixel.z();
  return u_px >= 0.0 && u_px < view.image_size_px.x() && v_px >= 0.0 && v_px < view.image_size_px.y();
}

std::size_t count_within(std::span<const Point> points, const Box3d& box) {
  return static_cast<std::size_t>(
      std::ranges::count_if(points, [&](const Point& point) { return is_within(point, box); }));
}

TrainingExample make_example(std::string name, std::vector<Point> points, std::span<const LabelledBox> labels,
                             const std::optional<LabelledView>& view, std::size_t min_points) {
  std::erase_if(points, [&](const Point& point) {
    return !point.p_lidar.allFinite() || (view && !shows(*view, point.p_lidar.cast<double>()));
  });
  TrainingExample example{std::move(name), std::move(points), {}, view};
  for (const LabelledBox& label : labels) {
    if (!is_usable(label.box)) continue;
    TrainingBox box{label};
    box.object_class = object_class_from(label.type).value_or(ObjectClass::other);
    box.points = count_within(example.points, label.box);
    box.demanded = box.points >= min_points;
    example.boxes.push_back(std::move(box));
  }
  return example;
}

}  // namespace mlo
