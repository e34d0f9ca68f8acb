#pragma once

#include <string>
#include <string_view>

#include "mlo/scene/records.hpp"

namespace mlo {

/// Points as bytes that compress well (docs/scene_format.md): coordinates in steps from an origin, one after
/// the other, each as difference to the point before; intensities in 255 steps of the largest.
/// @param step_m  how fine coordinates are kept; doubled until the farthest point fits into 16 bits
std::string encode_cloud(const SceneCloud& cloud, const Eigen::Vector3d& origin, double step_m);

/// @throws InputError when the bytes are not such a cloud
SceneCloud decode_cloud(std::string_view bytes, const std::string& source);

}  // namespace mlo
