#include "mlo/core/box.hpp"

#include <array>
#include <cctype>
#include <cmath>
#include <string>
#include <utility>

#include "mlo/core/heading.hpp"

namespace mlo {
namespace {

constexpr std::array<std::pair<std::string_view, ObjectClass>, 10> kNames{{
    {"car", ObjectClass::car},
    {"van", ObjectClass::van},
    {"truck", ObjectClass::truck},
    {"pedestrian", ObjectClass::pedestrian},
    {"cyclist", ObjectClass::cyclist},
    {"other", ObjectClass::other},
    // spellings of KITTI and others; the first entry of a class is the one that to_string gives
    {"person", ObjectClass::pedestrian},
    {"person_sitting", ObjectClass::pedestrian},
    {"tram", ObjectClass::other},
    {"misc", ObjectClass::other},
}};

}  // namespace

std::string_view to_string(ObjectClass object_class) {
  for (const auto& [name, value] : kNames) {
    if (value == object_class) return name;
  }
  return "other";
}

std::optional<ObjectClass> object_class_from(std::string_view name) {
  std::string lower;
  for (const char c : name) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const auto& [known, value] : kNames) {
    if (known == lower) return value;
  }
  return std::nullopt;
}

SE3 Box3d::T_lidar_object() const {
  return {so3_exp({0.0, 0.0, yaw_rad}), center_lidar_m};
}

bool Box3d::contains(const Eigen::Vector3d& p_lidar, double margin_m) const {
  const Eigen::Vector3d d = p_lidar - center_lidar_m;
  // Most points are far away: the circle around the box tells without its heading.
  const Eigen::Array2d reach_m = (0.5 * size_lwh_m.head<2>().array() + margin_m).max(0.0);
  if (d.head<2>().squaredNorm() > 1.001 * reach_m.matrix().squaredNorm()) return false;
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  const Eigen::Vector3d p_object(c * d.x() + s * d.y(), -s * d.x() + c * d.y(), d.z());
  return ((p_object.cwiseAbs() - 0.5 * size_lwh_m).array() <= margin_m).all();
}

Box3d upright_box(const SE3& T_lidar_object, const Eigen::Vector3d& size_lwh_m) {
  return {T_lidar_object.translation(), size_lwh_m, yaw_of(T_lidar_object)};
}

}  // namespace mlo
