#pragma once

#include <string>
#include <vector>

#include "mlo/core/object_record.hpp"

namespace mlo::test {

/// A car with a 60 x 40 px image box whose left edge is at x_px, and a 3D box at x_m to its left.
inline ObjectRecord car(std::size_t frame, long id, double x_px, double score = 1.0) {
  ObjectRecord record;
  record.frame = frame;
  record.track_id = id;
  record.type = "car";
  record.image_box = {x_px, 100.0, x_px + 60.0, 140.0};
  record.box = {{20.0, -0.1 * x_px, 0.0}, {6.0, 6.0, 1.5}, 0.0};
  record.score = score;
  return record;
}

/// Cars that stand still, far from each other: ids 0 ... count - 1 in every frame.
inline std::vector<ObjectRecord> standing_cars(std::size_t frames, long count) {
  std::vector<ObjectRecord> records;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    for (long id = 0; id < count; ++id) records.push_back(car(frame, id, 100.0 * static_cast<double>(id)));
  }
  return records;
}

}  // namespace mlo::test
