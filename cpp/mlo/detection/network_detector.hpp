#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"
#include "mlo/detection/config.hpp"
#include "mlo/network/network.hpp"

namespace mlo {

/// Objects in a scan by 3DSSD. Of boxes that overlap the most confident one is kept. Coordinates must be
/// finite.
/// @param is_ground  per point: 1 ground, 0 not; without any ground there are no objects
/// @return most confident first, in the lidar frame at the time of the scan; confidences are the network's,
/// at least min_candidate
std::vector<Detection> detect_with_network(std::span<const Point> points,
                                           std::span<const std::uint8_t> is_ground, const Network& network,
                                           const NetworkConfig& config);

/// The same for points in the network's frame (network_input.hpp), where the boxes are then, too.
std::vector<Detection> detect_in_network_frame(std::span<const Point> points, const Network& network,
                                               const NetworkConfig& config);

/// Why a network will do badly on scans like this one: it was trained with another kind of lidar, or one that
/// is mounted otherwise. One sentence with a remedy each; most often none.
/// @param up_lidar  normal of the ground near the lidar, of unit length
std::vector<std::string> find_mismatches(std::span<const Point> points, const Eigen::Vector3f& up_lidar,
                                         const NetworkArchitecture& architecture);

}  // namespace mlo
