#pragma once

#include <span>
#include <vector>

#include "mlo/core/box.hpp"

namespace mlo {

/// For each box, the share of its width as seen from the sensor (the range of azimuths it takes) that nearer
/// boxes cover, in [0, 1]. Heights are not looked at: objects stand on the same ground.
std::vector<double> hidden_shares(std::span<const Box3d> boxes);

/// Least angle between a box's corners and the border of a sector about straight ahead; negative when the box
/// is not wholly inside.
/// @param field_of_view_rad  the sector's full angle; 2 pi and more: there is no border, the margin is pi
double field_of_view_margin_rad(const Box3d& box, double field_of_view_rad);

}  // namespace mlo
