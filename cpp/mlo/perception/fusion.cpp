#include "mlo/perception/fusion.hpp"

#include "mlo/perception/objects.hpp"

namespace mlo {

std::vector<PointKind> correct_mutually(std::span<const std::uint8_t> is_ground,
                                        std::span<const std::uint16_t> object_ids) {
  std::vector<PointKind> kinds(is_ground.size());
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const bool in_object = object_ids[i] != kNoObject;
    if (is_ground[i] != 0) {
      kinds[i] = in_object ? PointKind::ambiguous : PointKind::ground;
    } else {
      kinds[i] = in_object ? PointKind::object : PointKind::background;
    }
  }
  return kinds;
}

std::vector<std::vector<Point>> collect_objects(std::span<const Point> points,
                                                std::span<const PointKind> kinds,
                                                std::span<const std::uint16_t> object_ids,
                                                std::size_t num_objects) {
  std::vector<std::vector<Point>> objects(num_objects);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (kinds[i] == PointKind::object) objects[object_ids[i]].push_back(points[i]);
  }
  return objects;
}

}  // namespace mlo
