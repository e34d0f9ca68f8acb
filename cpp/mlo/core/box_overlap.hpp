#pragma once

#include "mlo/core/box.hpp"

namespace mlo {

/// Intersection over union of areas, in [0, 1]; 0 if a box is empty.
double intersection_over_union(const Box2d& a, const Box2d& b);

/// Intersection over union of volumes, in [0, 1]; 0 if a box is empty.
double intersection_over_union(const Box3d& a, const Box3d& b);

/// Intersection over union of the ground areas (bird's-eye view), in [0, 1]; 0 if a box has none.
double footprint_iou(const Box3d& a, const Box3d& b);

/// Share of the box's area that lies in the region, in [0, 1]; 0 if the box is empty.
double covered_fraction(const Box2d& box, const Box2d& region);

}  // namespace mlo
