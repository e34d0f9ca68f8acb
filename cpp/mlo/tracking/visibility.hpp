#pragma once

#include <span>
#include <vector>

#include "mlo/core/box.hpp"

namespace mlo {

/// For each box, the share of its width as seen from the sensor (the range of azimuths it takes) that nearer
/// boxes cover, in [0, 1]. Heights are not looked at: objects stand on the same ground.
std::vector<double> hidden_shares(std::span<const Box3d> boxes);

/// True if the whole box lies in a sector about straight ahead.
/// @param field_of_view_rad  the sector's full angle; 2 pi and more: everything does
bool in_field_of_view(const Box3d& box, double field_of_view_rad);

}  // namespace mlo
