#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"
#include "mlo/evaluation/detection_ap.hpp"
#include "mlo/truth/detection_truth.hpp"

namespace mlo {

/// A true box to learn from, in the lidar frame. As a LabelledBox it is what `average_precision` takes.
struct TrainingBox : LabelledBox {
  ObjectClass object_class = ObjectClass::other;
  std::size_t points = 0;  ///< of the example that lie in it
  bool demanded = true;    ///< false: too few points to find it by; to be found or not, as it comes
};

/// One labelled scan.
struct TrainingExample {
  std::string name;  ///< where it is from, for messages
  std::vector<Point> points;
  std::vector<TrainingBox> boxes;  ///< everything labelled; what has a box of no class is `other`
  /// Where the labels end: points outside are left out. Nothing: labelled all round.
  std::optional<LabelledView> view;
};

/// True if a point of the lidar frame is seen in the image.
bool shows(const LabelledView& view, const Eigen::Vector3d& p_lidar);

inline bool is_within(const Point& point, const Box3d& box) {
  return box.contains(point.p_lidar.cast<double>());
}

/// Number of points within a box.
std::size_t count_within(std::span<const Point> points, const Box3d& box);

/// An example of labels and points: points that are not finite or not in the view are left out; boxes that
/// are not finite or have no volume, too. Boxes with fewer than min_points are not demanded.
TrainingExample make_example(std::string name, std::vector<Point> points, std::span<const LabelledBox> labels,
                             const std::optional<LabelledView>& view, std::size_t min_points);

}  // namespace mlo
