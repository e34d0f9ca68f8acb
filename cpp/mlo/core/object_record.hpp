#pragma once

#include <cstddef>
#include <string>

#include "mlo/core/box.hpp"

namespace mlo {

/// One object in one frame, as label and result files of the KITTI tracking benchmark describe it.
struct ObjectRecord {
  std::size_t frame = 0;
  long track_id = -1;  ///< below 0: no object (DontCare)
  std::string type;    ///< lower case: car, van, truck, pedestrian, person, cyclist, tram, misc, dontcare
  int truncation = 0;  ///< 0 none, 1 partly, 2 largely outside the image
  int occlusion = 0;   ///< 0 fully visible, 1 partly, 2 largely hidden, 3 unknown
  Box2d image_box;     ///< in the left colour image [px]; empty (right <= left) where the file has none
  Box3d box;  ///< with axes as a lidar's (x ahead, y left, z up) about the rectified camera 0, not the lidar
  double score = 1.0;  ///< of the tracker or detector; 1 where the file has none

  bool has_image_box() const { return image_box.right_px > image_box.left_px; }
};

}  // namespace mlo
