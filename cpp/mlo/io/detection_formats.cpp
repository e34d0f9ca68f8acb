#include "mlo/io/detection_formats.hpp"

#include <cmath>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/text.hpp"

namespace mlo {

void Place::fail(std::string_view problem, std::string_view remedy) const {
  const std::string at_line = line == 0 ? "" : fmt::format(":{}", line);
  throw InputError(fmt::format("{}{}: {}; {}", path.string(), at_line, problem, remedy));
}

void check_box(const Box3d& box, const Place& place) {
  if ((box.size_lwh_m.array() > 0.0).all() && box.size_lwh_m.allFinite() && box.center_lidar_m.allFinite() &&
      std::isfinite(box.yaw_rad)) {
    return;
  }
  place.fail(fmt::format("the box has sides of {} x {} x {} m", box.size_lwh_m.x(), box.size_lwh_m.y(),
                         box.size_lwh_m.z()),
             "give 3D boxes with positive length, width and height");
}

ObjectClass parse_class(std::string_view name, const Place& place) {
  if (const auto object_class = object_class_from(name)) return *object_class;
  place.fail(fmt::format("class '{}' is not known", name),
             "use car, van, truck, pedestrian, cyclist or other");
}

double parse_finite(std::string_view text, std::string_view what, const Place& place) {
  const auto number = parse_number(text);
  if (number && std::isfinite(*number)) return *number;
  place.fail(fmt::format("{} '{}' is not a number", what, text), "write the line again");
}

}  // namespace mlo
